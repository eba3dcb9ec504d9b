"""What the graphics card computes for each pixel: isolines, the body's glass, and the balls of the markers.

Each look is code put behind the tags of VTK's own shader templates, plus the uniforms that steer it.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from vtkmodules.vtkRenderingCore import vtkActor

from idviewer.view.colormaps import UNKNOWN_COLOR


@dataclass(frozen=True)
class Shader:
    """Code that is put behind tags of VTK's vertex and fragment templates."""

    vertex: dict[str, str] = field(default_factory=dict)
    fragment: dict[str, str] = field(default_factory=dict)

    def in_depth_range(self, depth_range: str) -> Shader:
        """The same with its depth in `BACK_DEPTH_RANGE` or `FRONT_DEPTH_RANGE`."""
        code = self.vertex.get(_POSITION_TAG, "") + depth_range
        return Shader({**self.vertex, _POSITION_TAG: code}, self.fragment)

    def install(self, actor: vtkActor, **uniforms: float) -> None:
        """Make an actor be drawn by this code, its uniforms set to these values."""
        looks = actor.GetShaderProperty()
        for tag, code in self.vertex.items():
            looks.AddVertexShaderReplacement(f"//VTK::{tag}", True, f"//VTK::{tag}\n{code}", False)
        for tag, code in self.fragment.items():
            looks.AddFragmentShaderReplacement(f"//VTK::{tag}", True, f"//VTK::{tag}\n{code}", False)
        set_uniforms(actor, **uniforms)


def set_uniforms(actor: vtkActor, **values: float) -> None:
    """Steer an actor's shader; values that are already set cost nothing."""
    uniforms = actor.GetShaderProperty().GetFragmentCustomUniforms()
    for name, value in values.items():
        uniforms.SetUniformf(name, value)


_POSITION_TAG = "CustomEnd::Impl"
"""The tag at which gl_Position is known."""

# Depths are kept on two ranges, so that a slice can be drawn over glass that is nearer to the eye, and still
# be hidden by another slice that is nearer. What is in the front range hides all that is in the back one.
BACK_DEPTH_RANGE = "gl_Position.z = 0.9 * gl_Position.z + 0.1 * gl_Position.w;\n"
FRONT_DEPTH_RANGE = "gl_Position.z = 0.1 * gl_Position.z - 0.9 * gl_Position.w;\n"


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

BALL_LIFT_SHARE = 0.01
"""How much nearer to the eye a ball is, as a share of its distance: a slice through it does not cut it."""

# Only the depth is moved. The depth of a point that is nearer by a share of its distance follows from the
# rows of the projection; in a parallel one, the distance is that from which 30 degrees see the same height.
_LIFTED = f"""
  vec3 depthRow = vec3(MCDCMatrix[0].z, MCDCMatrix[1].z, MCDCMatrix[2].z);
  vec3 upRow = vec3(MCDCMatrix[0].y, MCDCMatrix[1].y, MCDCMatrix[2].y);
  vec3 wRow = vec3(MCDCMatrix[0].w, MCDCMatrix[1].w, MCDCMatrix[2].w);
  float perspective = dot(wRow, wRow);
  if (perspective > 0.0) {{
    float slope = dot(depthRow, wRow) / perspective;
    float offset = MCDCMatrix[3].z - slope * MCDCMatrix[3].w;
    gl_Position.z = slope * gl_Position.w + offset / {1.0 - BALL_LIFT_SHARE};
  }}
  else {{ gl_Position.z -= {3.7 * BALL_LIFT_SHARE} * length(depthRow) / length(upRow); }}
"""

_BALL = {
    "Light::Impl": """
  vec2 ballAt = vec2(2.0, -2.0) * (gl_PointCoord - 0.5) * spriteRadius;
  float fromCentre = length(ballAt);
  float inRim = clamp(ballRadius + rimWidth + 0.5 - fromCentre, 0.0, 1.0);
  float inBall = clamp(ballRadius + 0.5 - fromCentre, 0.0, 1.0);
  vec2 tilt = ballAt / ballRadius;
  vec3 ballNormal = vec3(tilt, sqrt(max(1.0 - dot(tilt, tilt), 0.0)));
  float lit = max(dot(ballNormal, normalize(vec3(-0.35, 0.62, 0.70))), 0.0);
  vec3 ballColor = ambientColorUniform * (0.55 + 0.55 * lit) + vec3(0.55 * pow(lit, 40.0));
  ballColor = mix(ambientColorUniform, ballColor, relief);
  fragOutput0 = vec4(mix(vec3(1.0), min(ballColor, 1.0), inBall), opacity * inRim);
"""
}

BALL = Shader(vertex={_POSITION_TAG: _LIFTED}, fragment=_BALL)
"""A point drawn as a ball of constant size.

Uniforms: ballRadius, rimWidth, spriteRadius (half the point size) in pixels; relief (1 for a ball, 0 for a
disc).
"""

BALL_AT_FRONT = Shader(vertex={_POSITION_TAG: "gl_Position.z = -0.9999 * gl_Position.w;"}, fragment=_BALL)
"""The same in front of everything."""

_ON_SURFACE = "gl_Position.z -= 2e-3 * gl_Position.w;\n"

SURFACE_LINE = Shader(vertex={_POSITION_TAG: _ON_SURFACE})
"""A line that is drawn on the surface it lies in, not half below it.

About a pixel nearer: as far as the depth of a line and that of a steep surface may differ.
"""

LINE_JOINT = Shader(
    vertex={_POSITION_TAG: _ON_SURFACE},
    fragment={
        "Light::Impl": """
  float fromCentre = length(2.0 * (gl_PointCoord - 0.5)) * spriteRadius;
  fragOutput0 = vec4(ambientColorUniform, opacity * clamp(dotRadius + 0.5 - fromCentre, 0.0, 1.0));
"""
    },
)
"""A point of such a line, drawn as a disc.

Uniforms, in pixels: dotRadius, spriteRadius (half the point size).
"""

# Too little to change a colour of eight bits; with nothing at all, VTK discards the pixel and its depth.
DEPTH_ONLY = Shader(fragment={"Light::Impl": "fragOutput0 = vec4(0.0, 0.0, 0.0, 0.001);"})
"""Depth without colour."""
