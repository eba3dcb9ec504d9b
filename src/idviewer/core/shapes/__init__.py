"""Shapes: meshes, polygons and planes, and what is done to them."""
