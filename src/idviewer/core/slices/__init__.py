"""Slices: sections of shapes with planes, and their triangulation."""
