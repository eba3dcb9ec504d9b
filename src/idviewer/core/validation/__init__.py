"""Validation: what is wrong with the vertices and faces of a boundary, and its repairs."""
