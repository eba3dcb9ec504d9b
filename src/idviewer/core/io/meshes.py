"""The one door for mesh files: what comes out is a Mesh, or a MeshError of one line."""

from __future__ import annotations

import os
from pathlib import Path

from idviewer.core.io.contents import Contents, FileSource, PartError
from idviewer.core.io.files import bytes_of
from idviewer.core.io.formats import format_of, one_line
from idviewer.core.io.libraries import MissingLibraryError
from idviewer.core.io.text import UnreadableError
from idviewer.core.shapes.diagnosis import Diagnosis
from idviewer.core.shapes.mesh import Mesh, MeshError
from idviewer.core.shapes.raw_body import RawBody
from idviewer.core.shapes.repairs import NO_REPAIRS, Repairs
from idviewer.core.validation.polygon_soup import PolygonSoup
from idviewer.core.validation.repair_choices import ComponentChoice


def read_mesh(
    path: str | os.PathLike[str],
    component: ComponentChoice | None = None,
    part: str | None = None,
    repairs: Repairs = NO_REPAIRS,
) -> Mesh:
    """Read the mesh in a file by its suffix; `docs/mesh_files.md` tells what files may hold.

    What can be repaired is (see `idviewer.core.repair_mesh`), and every repair is a sentence in the mesh's
    notes. All objects of the file are read as one mesh, unless a part is chosen; materials and textures are
    not looked at.

    Args:
        path: of the file.
        component: which of several components to take, 1 or "largest" for that of the largest volume.
        part: which of several shapes in the file to take, by its name, where the format knows such.
        repairs: those that change the shape, to be made first; none by default.

    Raises:
        MeshError: there is no such file, it cannot be read, it is damaged, or what it holds is no closed
            surface. The message is one line that names the file, and the repairs that would close it.
    """
    return read_body(path, component, part).repaired(repairs).mesh_from(one_line(path))


def read_meshes(
    path: str | os.PathLike[str], part: str | None = None, repairs: Repairs = NO_REPAIRS
) -> tuple[Mesh, ...]:
    """Read the components of the mesh in a file, each as a mesh of its own, the largest volume first.

    Args:
        path, part, repairs: as in `read_mesh`.

    Raises:
        MeshError: as in `read_mesh`; also if one of the components is no closed surface.

    >>> from idviewer.core import sample_path
    >>> [mesh.name for mesh in read_meshes(sample_path("hand_2k"))]
    ['hand_2k']
    """
    return read_body(path, part=part).meshes(repairs, one_line(path))


def read_body(
    path: str | os.PathLike[str], component: ComponentChoice | None = None, part: str | None = None
) -> RawBody:
    """Read the polygons in a file, whether or not they make a mesh.

    Args:
        path: of the file.
        component: as in `read_mesh`.
        part: likewise.

    Raises:
        MeshError: there is no such file, or it cannot be read, or it is damaged.
    """
    path = Path(path)
    contents = _contents(path, part)
    return RawBody(contents.geometry, path.stem, contents.notes, contents.unit, component, contents.parts)


def inspect_file(
    path: str | os.PathLike[str],
    part: str | None = None,
    repairs: Repairs = NO_REPAIRS,
    component: ComponentChoice | None = None,
) -> Diagnosis:
    """Find the sizes of the mesh in a file and everything that is wrong with it, however unusable.

    Args:
        path: of the file.
        part: as in `read_mesh`.
        repairs, component: likewise.

    Raises:
        MeshError: there is no such file, or it cannot be read, or it is damaged.
    """
    return read_body(path, component, part).repaired(repairs).diagnosis


def _contents(path: Path, part: str | None) -> Contents[PolygonSoup]:
    """Read the polygons in a file, unchecked."""
    try:
        data = bytes_of(path, 3)
    except UnreadableError as error:
        raise MeshError(f"{one_line(path)}: {error}") from error
    known = format_of(path)
    assert known is not None
    where, kind = one_line(path), known.title
    try:
        return known.contents(FileSource(data, path, part))
    except PartError as error:
        raise MeshError(f"{where}: {one_line(error)}").with_parts(error.parts) from error
    except MissingLibraryError as error:
        raise MeshError(f"{where}: {one_line(error)}") from error
    except UnreadableError as error:
        raise MeshError(f"{where}: not a whole {kind} file: {one_line(error)}; export it again") from error
    except Exception as error:  # rubbish can make a parser raise anything; out of this door comes one line
        cause = one_line(f"{type(error).__name__}: {error}")[:100]
        raise MeshError(f"{where}: not a readable {kind} file ({cause}); export it again") from error
