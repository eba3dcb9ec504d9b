"""Vectors of LANES numbers for compiled kernels: a value type that LLVM keeps in vector registers.

numba vectorises plain loops only behind run-time checks that no arrays overlap; those checks cost more than
they gain in loops over a few numbers. Kernels therefore say what they mean: one variable holds LANES float64
or float32 numbers, and + - * /, comparisons and the functions below work on all of them at once. LLVM lowers
the vectors to whatever registers the processor has (a machine with narrower ones uses several).

Numbers beside a vector are converted to its type. Arrays are C-contiguous; an offset counts elements from the
array's start, whatever its shape, and is not checked.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterable
from typing import Any

import llvmlite.ir as ir
from numba import extending, types
from numba.core import cgutils
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
_BYTES = {types.float64: 8, types.float32: 4}


def _vector(lanes: LanesType) -> ir.VectorType:
    return ir.VectorType(_ELEMENTS[lanes.dtype], LANES)


@register_model(LanesType)
class _LanesModel(models.PrimitiveModel):
    def __init__(self, manager: Any, lanes: LanesType) -> None:
        super().__init__(manager, lanes, _vector(lanes))


@register_model(MaskType)
class _MaskModel(models.PrimitiveModel):
    def __init__(self, manager: Any, mask: MaskType) -> None:
        super().__init__(manager, mask, _MASK_VECTOR)


def _spread(builder: Any, value: Any) -> Any:
    """A vector that holds value in every lane."""
    nothing = ir.Constant(ir.VectorType(value.type, LANES), ir.Undefined)
    first = builder.insert_element(nothing, value, ir.Constant(ir.IntType(32), 0))
    zeros = ir.Constant(ir.VectorType(ir.IntType(32), LANES), None)
    return builder.shuffle_vector(first, nothing, zeros)


def _indices(lanes: Iterable[int]) -> Any:
    """Lanes for LLVM's shuffles; those of the second operand count on from LANES."""
    chosen = list(lanes)
    return ir.Constant(ir.VectorType(ir.IntType(32), len(chosen)), chosen)


def _common(*given: Any) -> Any:
    """The vectors' type if the rest are numbers; numba takes None for "no such operation"."""
    vectors = {one for one in given if isinstance(one, LanesType)}
    fits = all(isinstance(one, (LanesType, types.Float, types.Integer)) for one in given)
    return vectors.pop() if fits and len(vectors) == 1 else None


def _vectors(lanes: LanesType, context: Any, builder: Any, given: Any, values: Any) -> list[Any]:
    """The values as vectors; numbers among them are converted and spread."""
    return [
        value if one == lanes else _spread(builder, context.cast(builder, value, one, lanes.dtype))
        for one, value in zip(given, values, strict=True)
    ]


def _define(operation: Any, emit: Callable[..., Any], result: types.Type | None = None) -> None:
    """Give a binary operator its meaning for vectors; result is the vectors' own type if None."""

    @type_callable(operation)
    def _type_of(context: Any) -> Callable[..., Any]:
        def typer(a: Any, b: Any) -> Any:
            lanes = _common(a, b)
            return signature(result or lanes, a, b) if lanes else None

        return typer

    def lower(context: Any, builder: Any, sig: Any, values: Any) -> Any:
        vectors = _vectors(_common(*sig.args), context, builder, sig.args, values)
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


def intrinsic(function: Callable[..., Any]) -> Any:
    """As numba's, whose type lets no kernel call the result."""
    return extending.intrinsic(function)


def _pointer(context: Any, builder: Any, sig: Any, values: Any) -> Any:
    """Address of an element; an array and an offset are the first two arguments."""
    data = context.make_array(sig.args[0])(context, builder, values[0]).data
    return builder.gep(data, [values[1]])


def _lanes_of(array: Any) -> Any:
    """The vectors that an array is made of, None if it cannot be."""
    if isinstance(array, types.Array) and array.layout == "C" and array.dtype in _ELEMENTS:
        return LanesType(array.dtype)
    return None


@intrinsic
def load(typingctx, array, offset):  # type: ignore[no-untyped-def]
    """The vector array.ravel()[offset : offset + LANES]."""
    lanes = _lanes_of(array)

    def codegen(context, builder, sig, values):  # type: ignore[no-untyped-def]
        pointer = _pointer(context, builder, sig, values)
        return builder.load(builder.bitcast(pointer, _vector(lanes).as_pointer()), align=_BYTES[lanes.dtype])

    return (lanes(array, types.intp), codegen) if lanes else None


@intrinsic
def store(typingctx, array, offset, vector):  # type: ignore[no-untyped-def]
    """array.ravel()[offset : offset + LANES] = vector."""
    lanes = _lanes_of(array)

    def codegen(context, builder, sig, values):  # type: ignore[no-untyped-def]
        pointer = _pointer(context, builder, sig, values)
        pointer = builder.bitcast(pointer, _vector(lanes).as_pointer())
        builder.store(values[2], pointer, align=_BYTES[lanes.dtype])
        return context.get_dummy_value()

    return (types.none(array, types.intp, lanes), codegen) if lanes and lanes == vector else None


@intrinsic
def at(typingctx, array, offset):  # type: ignore[no-untyped-def]
    """The single number array.ravel()[offset], unchecked."""

    def codegen(context, builder, sig, values):  # type: ignore[no-untyped-def]
        return builder.load(_pointer(context, builder, sig, values))

    return array.dtype(array, types.intp), codegen


@intrinsic
def splat(typingctx, value):  # type: ignore[no-untyped-def]
    """A vector of one number: of float32 if the number is, of float64 otherwise."""
    dtype = types.float32 if value == types.float32 else types.float64

    def codegen(context, builder, sig, values):  # type: ignore[no-untyped-def]
        return _spread(builder, values[0])

    return LanesType(dtype)(dtype), codegen


@intrinsic
def choose(typingctx, mask, a, b):  # type: ignore[no-untyped-def]
    """From a where mask holds and from b elsewhere; one of the two may be a number."""
    lanes = _common(a, b)

    def codegen(context, builder, sig, values):  # type: ignore[no-untyped-def]
        return builder.select(values[0], *_vectors(lanes, context, builder, sig.args[1:], values[1:]))

    return (lanes(MASK, a, b), codegen) if lanes else None


def _extreme(sign: str) -> Any:
    def extreme(typingctx, a, b):  # type: ignore[no-untyped-def]
        lanes = _common(a, b)

        def codegen(context, builder, sig, values):  # type: ignore[no-untyped-def]
            a, b = _vectors(lanes, context, builder, sig.args, values)
            return builder.select(builder.fcmp_ordered(sign, a, b), a, b)

        return (lanes(a, b), codegen) if lanes else None

    return extreme


@intrinsic
def smaller(typingctx, a, b):  # type: ignore[no-untyped-def]
    """The smaller of a and b in each lane; b where one is NaN."""
    return _extreme("<")(typingctx, a, b)


@intrinsic
def larger(typingctx, a, b):  # type: ignore[no-untyped-def]
    """The larger of a and b in each lane; b where one is NaN."""
    return _extreme(">")(typingctx, a, b)


@intrinsic
def root(typingctx, a):  # type: ignore[no-untyped-def]
    """Square roots."""

    def codegen(context, builder, sig, values):  # type: ignore[no-untyped-def]
        vector = _vector(a)
        name = f"llvm.sqrt.v{LANES}f{8 * _BYTES[a.dtype]}"
        function = cgutils.get_or_insert_function(builder.module, ir.FunctionType(vector, [vector]), name)
        return builder.call(function, values)

    return (a(a), codegen) if isinstance(a, LanesType) else None


@intrinsic
def total(typingctx, a):  # type: ignore[no-untyped-def]
    """The sum of the lanes, added up in pairs."""

    def codegen(context, builder, sig, values):  # type: ignore[no-untyped-def]
        (rest,), width = values, LANES
        while width > 1:
            width //= 2
            halves = [
                builder.shuffle_vector(rest, rest, _indices(range(start, start + width)))
                for start in (0, width)
            ]
            rest = builder.fadd(*halves)
        return builder.extract_element(rest, ir.Constant(ir.IntType(32), 0))

    return (a.dtype(a), codegen) if isinstance(a, LanesType) else None


@intrinsic
def bits(typingctx, mask):  # type: ignore[no-untyped-def]
    """A mask as an integer, lane 0 in the lowest bit."""

    def codegen(context, builder, sig, values):  # type: ignore[no-untyped-def]
        packed = builder.bitcast(values[0], ir.IntType(LANES))
        return builder.zext(packed, context.get_value_type(types.intp))

    return (types.intp(MASK), codegen) if mask == MASK else None


@intrinsic
def any_of(typingctx, mask):  # type: ignore[no-untyped-def]
    """Whether a mask holds in any lane."""

    def codegen(context, builder, sig, values):  # type: ignore[no-untyped-def]
        packed = builder.bitcast(values[0], ir.IntType(LANES))
        return builder.icmp_unsigned("!=", packed, ir.Constant(packed.type, 0))

    return (types.boolean(MASK), codegen) if mask == MASK else None


@intrinsic
def transpose(typingctx, array, offset):  # type: ignore[no-untyped-def]
    """Turn rows into columns, in place, of the LANES vectors that begin at offset."""
    lanes = _lanes_of(array)

    def codegen(context, builder, sig, values):  # type: ignore[no-untyped-def]
        first = builder.bitcast(_pointer(context, builder, sig, values), _vector(lanes).as_pointer())
        places = [builder.gep(first, [ir.Constant(ir.IntType(64), i)]) for i in range(LANES)]
        rows = [builder.load(place, align=_BYTES[lanes.dtype]) for place in places]
        for step in (8, 4, 2, 1):
            keep = _indices(i if not i & step else LANES + i - step for i in range(LANES))
            swap = _indices(i + step if not i & step else LANES + i for i in range(LANES))
            for i in (i for i in range(LANES) if not i & step):
                pair = rows[i], rows[i + step]
                rows[i] = builder.shuffle_vector(*pair, keep)
                rows[i + step] = builder.shuffle_vector(*pair, swap)
        for row, place in zip(rows, places, strict=True):
            builder.store(row, place, align=_BYTES[lanes.dtype])
        return context.get_dummy_value()

    return (types.none(array, types.intp), codegen) if lanes else None


@intrinsic
def prefetch(typingctx, array, offset):  # type: ignore[no-untyped-def]
    """Ask for the line of memory that holds array.ravel()[offset], which will be read soon."""

    def codegen(context, builder, sig, values):  # type: ignore[no-untyped-def]
        word, address = ir.IntType(32), _pointer(context, builder, sig, values)
        address = builder.bitcast(address, ir.IntType(8).as_pointer())
        kind = ir.FunctionType(ir.VoidType(), [address.type, word, word, word])
        function = cgutils.get_or_insert_function(builder.module, kind, "llvm.prefetch.p0")
        builder.call(function, [address, word(0), word(3), word(1)])
        return context.get_dummy_value()

    return types.none(array, types.intp), codegen
