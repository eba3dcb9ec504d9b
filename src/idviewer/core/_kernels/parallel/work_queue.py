"""Work that threads take piece by piece, so that none is idle while another has much left."""

from __future__ import annotations

import llvmlite.ir as ir
from numba import types

from idviewer.core._kernels.simd.lanes import intrinsic


@intrinsic
def take_work(typingctx, counter):  # type: ignore[no-untyped-def]
    """Add one to counter[0], an array of int64 that threads share, and return what it was."""
    if not (isinstance(counter, types.Array) and counter.dtype == types.int64):
        return None

    def codegen(context, builder, sig, values):  # type: ignore[no-untyped-def]
        data = context.make_array(sig.args[0])(context, builder, values[0]).data
        return builder.atomic_rmw("add", data, ir.Constant(ir.IntType(64), 1), "monotonic")

    return types.int64(counter), codegen
