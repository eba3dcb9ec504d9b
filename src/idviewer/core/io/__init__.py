"""Files: readers of meshes and polygons, and the bundled shapes."""
