"""SIMD vectors, and the options of the compiler."""
