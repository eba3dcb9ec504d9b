"""Compiled loops over points and faces: closest points, collapses of edges."""
