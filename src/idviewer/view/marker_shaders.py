"""Markers and lines of constant size on the screen: balls, discs, lines that lie in a surface."""

from __future__ import annotations

from idviewer.view.shaders import POSITION_TAG, Shader

BALL_LIFT_SHARE = 0.01
"""Shift of a ball towards the eye, as a share of its distance: a slice through it does not cut it."""

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

BALL = Shader(vertex={POSITION_TAG: _LIFTED}, fragment=_BALL)
"""A point drawn as a ball of constant size.

Uniforms: ballRadius, rimWidth, spriteRadius (half the point size) in pixels; relief (1 for a ball, 0 for a
disc).
"""

BALL_AT_FRONT = Shader(vertex={POSITION_TAG: "gl_Position.z = -0.9999 * gl_Position.w;"}, fragment=_BALL)
"""The same in front of everything."""

_ON_SURFACE = "gl_Position.z -= 2e-3 * gl_Position.w;\n"

SURFACE_LINE = Shader(vertex={POSITION_TAG: _ON_SURFACE})
"""A line that is drawn on the surface it lies in, not half below it.

About a pixel nearer: as far as the depth of a line and that of a steep surface may differ.
"""

LINE_JOINT = Shader(
    vertex={POSITION_TAG: _ON_SURFACE},
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
