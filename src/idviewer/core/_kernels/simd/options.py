"""numba's options of the kernels."""

from __future__ import annotations

from typing import Any

TINY = 1e-300
"""Added where a denominator may vanish."""

FAST = {"contract", "nsz"}  # never anything that lets NaN or infinity be assumed away

OPTIONS: dict[str, Any] = {"fastmath": FAST, "error_model": "numpy"}
"""Of the kernels that work on SIMD vectors."""

ALLOCATION_FREE: dict[str, Any] = {**OPTIONS, "_nrt": False}
"""For functions that make no arrays: nothing is counted, and half as much code compiled."""

SCALAR: dict[str, Any] = {"error_model": "numpy", "cache": True}
"""Of the kernels that work on one number at a time, kept on disk between runs."""
