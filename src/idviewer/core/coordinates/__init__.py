"""Barycentric coordinates: what carries values at the vertices of a shape to the points inside."""
