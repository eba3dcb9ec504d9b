"""SIMD vectors, threads and the options of the compiler."""
