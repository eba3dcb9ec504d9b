"""The body as glass: seen through, the more clearly the more it faces the eye."""

from __future__ import annotations

from idviewer.view.shaders import Shader

# Light is swallowed on its way through a thin shell (Beer and Lambert), so grazing views see more of it.
_THROUGH_SHELL = """
  vec3 toEye = cameraParallel != 0 ? vec3(0.0, 0.0, 1.0) : normalize(-vertexVC.xyz);
  float facing = clamp(dot(normalVCVSOutput, toEye), 0.0, 1.0);
  vec3 keyLight = normalize(vec3(-0.35, 0.62, 0.70));
  float bright = smoothstep(0.1, 1.0, 0.5 + 0.5 * dot(normalVCVSOutput, keyLight));
  float clear = max(1.0 - opacity, 0.0);
"""

TRANSLUCENT_SURFACE = Shader(
    fragment={
        "Light::Impl": _THROUGH_SHELL
        + """
  // Of one colour, with the shading in alpha alone: layers give the same in whatever order they are blended.
  float alpha = 1.0 - pow(clear, mix(1.1, 0.45, bright) / max(facing, 0.05));
  fragOutput0 = vec4(0.38, 0.45, 0.56, alpha);
"""
    }
)
"""A body all of whose layers are seen; the opacity is that of its property."""

GLASS_SURFACE = Shader(
    fragment={
        "Light::Impl": _THROUGH_SHELL
        + """
  float alpha = 1.0 - pow(clear, 1.0 / max(facing, 0.05));
  vec3 glass = mix(vec3(0.38, 0.44, 0.54), vec3(0.76, 0.81, 0.87), bright);
  glass = mix(glass, vec3(0.22, 0.28, 0.38), (0.30 + 0.60 * clear) * pow(1.0 - facing, 1.7));
  float gloss = pow(max(dot(reflect(-keyLight, normalVCVSOutput), toEye), 0.0), 32.0);
  fragOutput0 = vec4(min(glass + 0.12 * gloss, 1.0), alpha);
"""
    }
)
"""A body of which the nearest layer is seen."""
