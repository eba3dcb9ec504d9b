"""The type of vectors of LANES numbers, and what operators mean for it; see `lanes`."""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterable
from typing import Any

import llvmlite.ir as ir
from numba import types
from numba.core.typing.templates import signature
from numba.extending import lower_builtin, models, register_model, type_callable

LANES = 16
"""Numbers in a vector: two of the widest registers of float64, one of float32."""

FLAGS = ("contract", "nsz")  # never anything that lets NaN or infinity be assumed away


class LanesType(types.Type):
    """The type of a vector of LANES float64 or float32 numbers."""

    def __init__(self, dtype: types.Float) -> None:
        self.dtype = dtype
        super().__init__(name=f"Lanes({dtype})")


class MaskType(types.Type):
    """The type of LANES truth values."""

    def __init__(self) -> None:
        super().__init__(name="Mask")


MASK = MaskType()
_MASK_VECTOR = ir.VectorType(ir.IntType(1), LANES)
_ELEMENTS = {types.float64: ir.DoubleType(), types.float32: ir.FloatType()}
BYTES = {types.float64: 8, types.float32: 4}


def vector_of(lanes: LanesType) -> ir.VectorType:
    """Name of the vector type in LLVM."""
    return ir.VectorType(_ELEMENTS[lanes.dtype], LANES)


@register_model(LanesType)
class _LanesModel(models.PrimitiveModel):
    def __init__(self, manager: Any, lanes: LanesType) -> None:
        super().__init__(manager, lanes, vector_of(lanes))


@register_model(MaskType)
class _MaskModel(models.PrimitiveModel):
    def __init__(self, manager: Any, mask: MaskType) -> None:
        super().__init__(manager, mask, _MASK_VECTOR)


def spread(builder: Any, value: Any) -> Any:
    """A vector that holds value in every lane."""
    nothing = ir.Constant(ir.VectorType(value.type, LANES), ir.Undefined)
    first = builder.insert_element(nothing, value, ir.Constant(ir.IntType(32), 0))
    zeros = ir.Constant(ir.VectorType(ir.IntType(32), LANES), None)
    return builder.shuffle_vector(first, nothing, zeros)


def indices(lanes: Iterable[int]) -> Any:
    """Lanes for LLVM's shuffles; those of the second operand count on from LANES."""
    chosen = list(lanes)
    return ir.Constant(ir.VectorType(ir.IntType(32), len(chosen)), chosen)


def common(*given: Any) -> Any:
    """The vectors' type if the rest are numbers; numba takes None for "no such operation"."""
    vectors = {one for one in given if isinstance(one, LanesType)}
    fits = all(isinstance(one, (LanesType, types.Float, types.Integer)) for one in given)
    return vectors.pop() if fits and len(vectors) == 1 else None


def vectors_of(lanes: LanesType, context: Any, builder: Any, given: Any, values: Any) -> list[Any]:
    """The values as vectors; numbers among them are converted and spread."""
    return [
        value if one == lanes else spread(builder, context.cast(builder, value, one, lanes.dtype))
        for one, value in zip(given, values, strict=True)
    ]


def _define(operation: Any, emit: Callable[..., Any], result: types.Type | None = None) -> None:
    """Give a binary operator its meaning for vectors; result is the vectors' own type if None."""

    @type_callable(operation)
    def _type_of(context: Any) -> Callable[..., Any]:
        def typer(a: Any, b: Any) -> Any:
            lanes = common(a, b)
            return signature(result or lanes, a, b) if lanes else None

        return typer

    def lower(context: Any, builder: Any, sig: Any, values: Any) -> Any:
        vectors = vectors_of(common(*sig.args), context, builder, sig.args, values)
        return emit(builder, *vectors)

    for pair in ((LanesType, LanesType), (LanesType, types.Number), (types.Number, LanesType)):
        lower_builtin(operation, *pair)(lower)


_define(operator.add, lambda builder, a, b: builder.fadd(a, b, flags=FLAGS))
_define(operator.sub, lambda builder, a, b: builder.fsub(a, b, flags=FLAGS))
_define(operator.mul, lambda builder, a, b: builder.fmul(a, b, flags=FLAGS))
_define(operator.truediv, lambda builder, a, b: builder.fdiv(a, b, flags=FLAGS))
_define(operator.lt, lambda builder, a, b: builder.fcmp_ordered("<", a, b), MASK)
_define(operator.le, lambda builder, a, b: builder.fcmp_ordered("<=", a, b), MASK)
_define(operator.gt, lambda builder, a, b: builder.fcmp_ordered(">", a, b), MASK)
_define(operator.ge, lambda builder, a, b: builder.fcmp_ordered(">=", a, b), MASK)
