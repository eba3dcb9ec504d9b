"""Files: readers of meshes and polygons, and the bundled shapes."""

from idviewer.core.io.atomic_write import PART_SUFFIX, atomic_path
from idviewer.core.io.bundled_shapes import DEFAULT_SAMPLE, Sample, all_samples, sample_names, sample_path
from idviewer.core.io.contents import Contents, FileSource, PartError
from idviewer.core.io.formats import add_reader, readable_suffixes
from idviewer.core.io.memory_bound import MEMORY_BOUND
from idviewer.core.io.mesh_writers import check_mesh_path, writable_suffixes, write_mesh
from idviewer.core.io.meshes import inspect_file, read_body, read_mesh, read_meshes
from idviewer.core.io.point_tables import PointTable, read_points, rounding_of
from idviewer.core.io.polygons import read_polygon, read_shape, write_polygon
from idviewer.core.io.text import UnreadableError

__all__ = [
    "DEFAULT_SAMPLE",
    "MEMORY_BOUND",
    "PART_SUFFIX",
    "Contents",
    "FileSource",
    "PartError",
    "PointTable",
    "Sample",
    "UnreadableError",
    "add_reader",
    "all_samples",
    "atomic_path",
    "check_mesh_path",
    "inspect_file",
    "read_body",
    "read_mesh",
    "read_meshes",
    "read_points",
    "read_polygon",
    "read_shape",
    "readable_suffixes",
    "rounding_of",
    "sample_names",
    "sample_path",
    "writable_suffixes",
    "write_mesh",
    "write_polygon",
]
