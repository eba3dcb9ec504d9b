"""Isolines of a slice, drawn by the graphics card: equally spaced in distance, as sharp as the screen."""

from __future__ import annotations

from idviewer.view.colormaps import UNKNOWN_COLOR
from idviewer.view.shaders import Shader


def _vec3(rgb: tuple[float, float, float]) -> str:
    return f"vec3({', '.join(f'{value:.4f}' for value in rgb)})"


ISOLINES = Shader(
    vertex={
        "Color::Dec": "in float level;\nin float known;\nout float levelVS;\nout float knownVS;",
        "Color::Impl": "levelVS = level;\nknownVS = known;",
    },
    fragment={
        "Color::Dec": "in float levelVS;\nin float knownVS;",
        # Derivatives need every pixel of a 2 x 2 block, so they come before anything is discarded.
        "UniformFlow::Impl": """
  float isoSteps = levelVS * isolines;
  float isoPerPixel = max(length(vec2(dFdx(isoSteps), dFdy(isoSteps))), 1e-12);
""",
        "Light::Impl": f"""
  float isoNearest = floor(isoSteps + 0.5);
  float isoPixels = abs(isoSteps - isoNearest) / isoPerPixel;
  float isoline = clamp(0.5 * lineWidth + 0.5 - isoPixels, 0.0, 1.0);
  // Between the ends of the range only, and only where there is room between two lines.
  isoline *= step(0.5, isoNearest) * step(isoNearest, isolines - 0.5);
  isoline *= 1.0 - smoothstep(0.22, 0.45, isoPerPixel * lineWidth);
  fragOutput0.rgb = mix(fragOutput0.rgb, vec3(0.02, 0.02, 0.05), 0.75 * isoline);
  if (knownVS < 0.999) {{ fragOutput0.rgb = {_vec3(UNKNOWN_COLOR)}; }}
""",
    },
)
"""A slice. Attributes: level (0 to 1 over the value range), known (0 where the value is NaN).

Uniforms: isolines (steps the range is divided in), lineWidth (pixels).
"""
