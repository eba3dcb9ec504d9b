"""Shaders: code put behind the tags of VTK's own templates, and the uniforms that steer it."""

from __future__ import annotations

from dataclasses import dataclass, field

from vtkmodules.vtkRenderingCore import vtkActor


@dataclass(frozen=True)
class Shader:
    """Code that is put behind tags of VTK's vertex and fragment templates."""

    vertex: dict[str, str] = field(default_factory=dict)
    fragment: dict[str, str] = field(default_factory=dict)

    def in_depth_range(self, depth_range: str) -> Shader:
        """The same with its depth in `BACK_DEPTH_RANGE` or `FRONT_DEPTH_RANGE`."""
        code = self.vertex.get(POSITION_TAG, "") + depth_range
        return Shader({**self.vertex, POSITION_TAG: code}, self.fragment)

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


POSITION_TAG = "CustomEnd::Impl"
"""The tag at which gl_Position is known."""

# Depths are kept on two ranges, so that a slice can be drawn over glass that is nearer to the eye, and still
# be hidden by another slice that is nearer. What is in the front range hides all that is in the back one.
BACK_DEPTH_RANGE = "gl_Position.z = 0.9 * gl_Position.z + 0.1 * gl_Position.w;\n"
FRONT_DEPTH_RANGE = "gl_Position.z = 0.1 * gl_Position.z - 0.9 * gl_Position.w;\n"


# Too little to change a colour of eight bits; with nothing at all, VTK discards the pixel and its depth.
DEPTH_ONLY = Shader(fragment={"Light::Impl": "fragOutput0 = vec4(0.0, 0.0, 0.0, 0.001);"})
"""Depth without colour."""
