"""Vectors of LANES numbers for compiled kernels: a value type that LLVM keeps in vector registers.

numba vectorises plain loops only behind run-time checks that no arrays overlap; those checks cost more than
they gain in loops over a few numbers. Kernels therefore say what they mean: one variable holds LANES float64
or float32 numbers, and + - * /, comparisons and the functions below work on all of them at once. LLVM lowers
the vectors to whatever registers the processor has (a machine with narrower ones uses several).

Numbers beside a vector are converted to its type. Arrays are C-contiguous; an offset counts elements from the
array's start, whatever its shape, and is not checked.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import llvmlite.ir as ir
from numba import extending, types
from numba.core import cgutils

from idviewer.core._kernels.simd.lane_types import (
    BYTES,
    LANES,
    MASK,
    LanesType,
    common,
    indices,
    spread,
    vector_of,
    vectors_of,
)


def intrinsic(function: Callable[..., Any]) -> Any:
    """As numba's, whose type lets no kernel call the result."""
    return extending.intrinsic(function)


def _pointer(context: Any, builder: Any, sig: Any, values: Any) -> Any:
    """Address of an element; an array and an offset are the first two arguments."""
    data = context.make_array(sig.args[0])(context, builder, values[0]).data
    return builder.gep(data, [values[1]])


def _lanes_of(array: Any) -> Any:
    """The vectors that an array is made of, None if it cannot be."""
    if isinstance(array, types.Array) and array.layout == "C" and array.dtype in BYTES:
        return LanesType(array.dtype)
    return None


@intrinsic
def load(typingctx, array, offset):  # type: ignore[no-untyped-def]
    """The vector array.ravel()[offset : offset + LANES]."""
    lanes = _lanes_of(array)

    def codegen(context, builder, sig, values):  # type: ignore[no-untyped-def]
        pointer = _pointer(context, builder, sig, values)
        return builder.load(builder.bitcast(pointer, vector_of(lanes).as_pointer()), align=BYTES[lanes.dtype])

    return (lanes(array, types.intp), codegen) if lanes else None


@intrinsic
def store(typingctx, array, offset, vector):  # type: ignore[no-untyped-def]
    """array.ravel()[offset : offset + LANES] = vector."""
    lanes = _lanes_of(array)

    def codegen(context, builder, sig, values):  # type: ignore[no-untyped-def]
        pointer = _pointer(context, builder, sig, values)
        pointer = builder.bitcast(pointer, vector_of(lanes).as_pointer())
        builder.store(values[2], pointer, align=BYTES[lanes.dtype])
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
        return spread(builder, values[0])

    return LanesType(dtype)(dtype), codegen


@intrinsic
def widened(typingctx, a):  # type: ignore[no-untyped-def]
    """A vector of float32 in float64."""

    def codegen(context, builder, sig, values):  # type: ignore[no-untyped-def]
        return builder.fpext(values[0], vector_of(sig.return_type))

    return (LanesType(types.float64)(a), codegen) if a == LanesType(types.float32) else None


@intrinsic
def choose(typingctx, mask, a, b):  # type: ignore[no-untyped-def]
    """From a where mask holds and from b elsewhere; one of the two may be a number."""
    lanes = common(a, b)

    def codegen(context, builder, sig, values):  # type: ignore[no-untyped-def]
        return builder.select(values[0], *vectors_of(lanes, context, builder, sig.args[1:], values[1:]))

    return (lanes(MASK, a, b), codegen) if lanes else None


def _extreme(sign: str) -> Any:
    def extreme(typingctx, a, b):  # type: ignore[no-untyped-def]
        lanes = common(a, b)

        def codegen(context, builder, sig, values):  # type: ignore[no-untyped-def]
            a, b = vectors_of(lanes, context, builder, sig.args, values)
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
        vector = vector_of(a)
        name = f"llvm.sqrt.v{LANES}f{8 * BYTES[a.dtype]}"
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
                builder.shuffle_vector(rest, rest, indices(range(start, start + width)))
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
        first = builder.bitcast(_pointer(context, builder, sig, values), vector_of(lanes).as_pointer())
        places = [builder.gep(first, [ir.Constant(ir.IntType(64), i)]) for i in range(LANES)]
        rows = [builder.load(place, align=BYTES[lanes.dtype]) for place in places]
        for step in (8, 4, 2, 1):
            keep = indices(i if not i & step else LANES + i - step for i in range(LANES))
            swap = indices(i + step if not i & step else LANES + i for i in range(LANES))
            for i in (i for i in range(LANES) if not i & step):
                pair = rows[i], rows[i + step]
                rows[i] = builder.shuffle_vector(*pair, keep)
                rows[i + step] = builder.shuffle_vector(*pair, swap)
        for row, place in zip(rows, places, strict=True):
            builder.store(row, place, align=BYTES[lanes.dtype])
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
