"""The table of file formats: which suffix holds which kind of shape, and who reads it."""

from __future__ import annotations

import importlib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from idviewer.core.io.abaqus import read_abaqus
from idviewer.core.io.contents import Contents, FileSource
from idviewer.core.io.gltf import read_glb, read_gltf
from idviewer.core.io.library_readers import read_freesurfer, read_gifti, read_gmsh
from idviewer.core.io.obj import read_obj
from idviewer.core.io.off import read_off
from idviewer.core.io.ply import read_ply
from idviewer.core.io.polygon_json import read_json
from idviewer.core.io.polygon_tables import read_csv
from idviewer.core.io.stl import read_stl
from idviewer.core.io.wkt import read_wkt

Reader = Callable[[FileSource], Any]
"""From a file to the Contents of it: of a PolygonSoup, or of a polygon's loops; or to those themselves."""


@dataclass(frozen=True)
class FileFormat:
    """Contents of files of one suffix.

    Attributes:
        suffix: in lower case and with its dot; of two parts perhaps, such as ".nii.gz".
        title: what messages call the format.
        dimension: of the shapes in it, 3 for meshes, 2 for polygons.
        read: see `Reader`; None if that is left to another package.
        hint: how to get the reader, for messages, where there is none.
        holds_parts: whether a file may hold several shapes, of which the reader takes a chosen one.
        usual: whether messages offer to save a shape as such a file.
    """

    suffix: str
    title: str
    dimension: int
    read: Reader | None
    hint: str = ""
    holds_parts: bool = False
    usual: bool = True

    def contents(self, source: FileSource) -> Contents[Any]:
        """Read a file.

        Args:
            source: the file.

        Raises:
            UnreadableError: it is damaged, or has no such part; also any other exception of the reader.
        """
        assert self.read is not None
        if not self.holds_parts:
            source.refuse_part()
        found = self.read(source)
        return found if isinstance(found, Contents) else Contents(found)


def _late(module: str, name: str) -> Reader:
    """A reader that is loaded when it is needed, as it takes a while."""

    def read(source: FileSource) -> Any:
        return getattr(importlib.import_module(f"idviewer.core.io.{module}"), name)(source)

    return read


_OF_FREESURFER = (
    *(".pial", ".white", ".orig", ".smoothwm", ".inflated", ".sphere", ".midthickness", ".graymid"),
    *(".pial.t1", ".pial.t2", ".white.preaparc", ".white.h", ".white.k", ".sphere.reg"),
    *(".orig.nofix", ".orig.premesh", ".inflated.nofix", ".smoothwm.nofix", ".qsphere.nofix"),
)
"""What follows lh. and rh. in the names of surfaces."""

_NIFTI, _MGH, _META = (
    _late("nifti", "read_nifti"),
    _late("nifti", "read_mgh"),
    _late("metaimage", "read_metaimage"),
)
_NRRD, _TIFF = _late("nrrd", "read_nrrd"), _late("image_stacks", "read_tiff")
_FROM_VTK = "call idviewer.view.vtk_files.register_vtk_reader, which needs VTK"
_FORMATS = {
    one.suffix: one
    for one in (
        FileFormat(".off", "OFF", 3, lambda source: read_off(source.data)),
        FileFormat(".obj", "OBJ", 3, read_obj, holds_parts=True),
        FileFormat(".ply", "PLY", 3, lambda source: read_ply(source.data)),
        FileFormat(".stl", "STL", 3, lambda source: read_stl(source.data)),
        FileFormat(".glb", "GLB", 3, read_glb, holds_parts=True),
        FileFormat(".gltf", "glTF", 3, read_gltf, holds_parts=True),
        FileFormat(".3mf", "3MF", 3, _late("threemf", "read_3mf"), holds_parts=True),
        FileFormat(".msh", "Gmsh", 3, read_gmsh, usual=False),
        FileFormat(".inp", "Abaqus", 3, read_abaqus, holds_parts=True, usual=False),
        FileFormat(".gii", "GIFTI", 3, read_gifti, holds_parts=True, usual=False),
        *(FileFormat(suffix, "FreeSurfer", 3, read_freesurfer, usual=False) for suffix in _OF_FREESURFER),
        FileFormat(".vtp", "VTP", 3, None, _FROM_VTK),
        FileFormat(".vtu", "VTU", 3, None, _FROM_VTK),
        FileFormat(".vtk", "VTK", 3, None, _FROM_VTK),
        FileFormat(".nii", "NIfTI", 3, _NIFTI, holds_parts=True),
        FileFormat(".nii.gz", "NIfTI", 3, _NIFTI, holds_parts=True),
        FileFormat(".mgz", "MGZ", 3, _MGH, holds_parts=True),
        FileFormat(".mgh", "MGH", 3, _MGH, holds_parts=True),
        FileFormat(".mha", "MetaImage", 3, _META, holds_parts=True),
        FileFormat(".mhd", "MetaImage", 3, _META, holds_parts=True),
        FileFormat(".nrrd", "NRRD", 3, _NRRD, holds_parts=True),
        FileFormat(".nhdr", "NRRD", 3, _NRRD, holds_parts=True),
        FileFormat(".tif", "TIFF", 3, _TIFF, holds_parts=True),
        FileFormat(".tiff", "TIFF", 3, _TIFF, holds_parts=True),
        FileFormat(".npy", "NPY", 3, _late("image_stacks", "read_npy"), holds_parts=True),
        FileFormat(".csv", "CSV", 2, read_csv, holds_parts=True),
        FileFormat(".svg", "SVG", 2, _late("svg", "read_svg"), holds_parts=True),
        FileFormat(".json", "JSON", 2, read_json, holds_parts=True),
        FileFormat(".geojson", "GeoJSON", 2, read_json, holds_parts=True),
        FileFormat(".wkt", "WKT", 2, read_wkt, holds_parts=True),
    )
}


def add_reader(
    suffixes: tuple[str, ...], read: Reader | None, hint: str = "", holds_parts: bool = False
) -> None:
    """Have `read_mesh` read files of further suffixes, or of known ones by another reader.

    Args:
        suffixes: with their dots, such as (".vtp",) or (".nii.gz",).
        read: makes polygons (a `PolygonSoup`, or `Contents` of one) of a `FileSource`. Of a damaged file it
            raises UnreadableError, in words for the file's owner, or any other exception. None if the suffix
            is known only.
        hint: how to get the reader, for messages, where `read` is None.
        holds_parts: whether a file may hold several shapes; see `FileSource.chosen`.

    Raises:
        ValueError: a suffix does not begin with a dot.

    >>> add_reader((".abc",), None, "it comes with the package abc")
    >>> format_of(Path("thing.abc")).hint
    'it comes with the package abc'
    """
    for suffix in map(str.lower, suffixes):
        if not suffix.startswith(".") or len(suffix) < 2:
            raise ValueError(f"a suffix begins with a dot, unlike {suffix!r}")
        _FORMATS[suffix] = FileFormat(suffix, suffix[1:].upper(), 3, read, hint, holds_parts)


def readable_suffixes(dimension: int | None = None) -> tuple[str, ...]:
    """Suffixes of the files that can be read, in lower case and with their dot.

    Args:
        dimension: 3 for those of meshes alone, 2 for those of polygons.

    >>> readable_suffixes(2)
    ('.csv', '.svg', '.json', '.geojson', '.wkt')
    """
    known = _FORMATS.values()
    return tuple(one.suffix for one in known if one.read and dimension in (None, one.dimension))


def format_of(path: Path) -> FileFormat | None:
    """Look up the format of a file by its suffix; None if it is not known.

    >>> format_of(Path("thing.GLTF")).title
    'glTF'
    """
    return _FORMATS.get("".join(path.suffixes[-2:]).lower()) or _FORMATS.get(path.suffix.lower())


def why_unreadable(path: Path, dimension: int | None = None) -> str:
    """The fault of a file's suffix, and what to do; empty if there is a reader.

    Args:
        path: of the file.
        dimension: of the shape that is looked for, 2 or 3; either by default.

    >>> why_unreadable(Path("a.doc"), 2)
    "'.doc' files hold no polygon; save it as one of .csv, .svg, .json, .geojson, .wkt"
    """
    suffixes = readable_suffixes(dimension)
    known = format_of(path)
    suffix = path.suffix.lower() if known is None else known.suffix
    if suffix in suffixes:
        return ""
    if not suffix:
        problem = "a suffix must tell the file's format"
    elif known is not None and known.read is None and dimension in (None, known.dimension):
        problem = f"the reader of '{suffix}' files is missing ({known.hint})"
    else:
        problem = f"'{one_line(suffix)}' files {'hold no polygon' if dimension == 2 else 'cannot be read'}"
    usual = [one for one in suffixes if _FORMATS[one].usual]
    return f"{problem}; save it as one of {', '.join(usual)}"


def one_line(thing: object) -> str:
    r"""A path or a cause on one line, whatever it is made of.

    >>> one_line("two\nlines")
    'two?lines'
    """
    return "".join(letter if letter.isprintable() else "?" for letter in str(thing))
