"""Files: readers of meshes and polygons, and the bundled shapes."""

from idviewer.core.io.meshes import READABLE_SUFFIXES, inspect_file
from idviewer.core.io.polygons import POLYGON_SUFFIXES
from idviewer.core.io.samples import DEFAULT_SAMPLE

__all__ = ["DEFAULT_SAMPLE", "POLYGON_SUFFIXES", "READABLE_SUFFIXES", "inspect_file"]
