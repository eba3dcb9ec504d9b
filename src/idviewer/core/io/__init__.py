"""Files: readers of meshes and polygons, and the bundled shapes."""

from idviewer.core.io.atomic_write import PART_SUFFIX, atomic_path
from idviewer.core.io.meshes import READABLE_SUFFIXES, inspect_file
from idviewer.core.io.polygons import POLYGON_SUFFIXES
from idviewer.core.io.samples import DEFAULT_SAMPLE
from idviewer.core.io.text import UnreadableError

__all__ = [
    "DEFAULT_SAMPLE",
    "PART_SUFFIX",
    "POLYGON_SUFFIXES",
    "READABLE_SUFFIXES",
    "UnreadableError",
    "atomic_path",
    "inspect_file",
]
