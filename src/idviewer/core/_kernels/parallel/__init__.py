"""Parallel loops: the number of threads, and work that they take piece by piece."""
