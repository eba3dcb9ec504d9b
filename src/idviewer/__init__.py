"""Distances inside shapes: a viewer, a session that drives it, and a numerical core."""

__version__ = "0.1.0"
