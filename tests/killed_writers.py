"""Writers that are killed: `python -m tests.killed_writers --kills 1000 --seed 2009`.

A process for each trial writes two versions of a file in turn until it is killed with SIGKILL; what is found
afterwards has to be one of them, whole. Needs `os.fork`, which Windows has not.
"""

from __future__ import annotations

import argparse
import json
import os
import signal
import sys
import tempfile
import time
from abc import ABC, abstractmethod
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image
from tests.core import shapes

from idviewer.batch.result_files import Made, content_of, write_result
from idviewer.batch.task import Task
from idviewer.cli.point_distances import write
from idviewer.core import Mesh, Polygon, Spectrum, read_mesh, read_polygon, write_mesh, write_polygon
from idviewer.core.io import PART_SUFFIX, writable_suffixes
from idviewer.core.steps import finish
from idviewer.session.array_cache import ArrayCache
from idviewer.session.cached_view import VIEW_STEM_END
from idviewer.session.spectrum_cache import SpectrumCache
from idviewer.session.state import State
from idviewer.view import images
from idviewer.view.vtk_writers import write_vtp

LONGEST_SECONDS = 0.03
"""That a writer lives after its first file."""
VERTICES, FACES = shapes.icosphere(3)


class Kind(ABC):
    """A kind of file.

    Args:
        folder: of the files.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    @property
    def name(self) -> str:
        """For the table."""
        return type(self).__name__

    @abstractmethod
    def write(self, version: int) -> None:
        """Write a version, 1 or 2, over the other."""

    @abstractmethod
    def read(self) -> object:
        """The version that is there; anything else is a fault."""


class Picture(Kind):
    def write(self, version: int) -> None:
        pixels = np.random.default_rng(0).integers(0, 120, (160, 200, 3)).astype(np.uint8) * np.uint8(version)
        images._image_of_all = lambda *_: pixels  # drawing needs a graphics driver, which does not fork
        images.write_image(self.folder / "picture.png", State(), None, (200, 160))

    def read(self) -> object:
        pixels = np.asarray(Image.open(self.folder / "picture.png"))
        known = np.random.default_rng(0).integers(0, 120, (160, 200, 3))
        return _which(pixels, known)


class MeshFile(Kind):
    def __init__(self, folder: Path, suffix: str) -> None:
        super().__init__(folder)
        self.path = folder / f"mesh{suffix}"

    @property
    def name(self) -> str:
        return f"Mesh {self.path.suffix}"

    def write(self, version: int) -> None:
        write_mesh(Mesh(version * VERTICES, FACES), self.path)

    def read(self) -> object:
        mesh = read_mesh(self.path)
        size = float(np.linalg.norm(mesh.vertices, axis=1).mean())
        return round(size) if len(mesh.faces) == len(FACES) and abs(size - round(size)) < 1e-6 else mesh


class PolygonFile(MeshFile):
    @property
    def name(self) -> str:
        return f"Polygon {self.path.suffix}"

    def write(self, version: int) -> None:
        write_polygon(Polygon(version * shapes.star(400)), self.path)

    def read(self) -> object:
        return _which(read_polygon(self.path).vertices, shapes.star(400))


class Table(Kind):
    """Results of the command line."""

    def write(self, version: int) -> None:
        write(f"{version},0.123456789\n" * 20_000, str(self.folder / "table.csv"))

    def read(self) -> object:
        lines = (self.folder / "table.csv").read_text().split()
        return int(lines[0][0]) if len(lines) == 20_000 and len(set(lines)) == 1 else lines


class Fields(Kind):
    def write(self, version: int) -> None:
        write_vtp(self.folder / "fields.vtp", version * VERTICES, FACES, {"height": VERTICES[:, 2].copy()})

    def read(self) -> object:
        return _which(_vtp_points(self.folder / "fields.vtp"), VERTICES)


class BatchResult(Kind):
    def write(self, version: int) -> None:
        task = Task("one", self.folder / "one.ply")
        write_result(self.folder, task, "key", Made({"values": [version] * 5000}, {}, {}), 1.0)

    def read(self) -> object:
        (path,) = (one for one in self.folder.iterdir() if one.suffix == ".json")
        content = content_of(path)
        assert content is not None, "half a file"
        values = content["result"]["values"]
        return values[0] if len(values) == 5000 and len(set(values)) == 1 else values


class Eigenpairs(Kind):
    shape = Polygon([[0, 0], [1, 0], [1, 1], [0, 1]])

    def write(self, version: int) -> None:
        values, vectors = version * np.arange(1.0, 4), np.full((4, 3), float(version))
        spectrum = Spectrum(values, vectors, np.ones(4), 0.0, np.inf)
        SpectrumCache(self.folder / "cache").store(self.shape, spectrum)

    def read(self) -> object:
        found = finish(SpectrumCache(self.folder / "cache").lookup_steps(self.shape, lambda _: np.inf))
        assert found.spectrum is not None, found.complaint
        return _which(found.spectrum.values, np.arange(1.0, 4))


class FirstViews(Kind):
    def write(self, version: int) -> None:
        cache = ArrayCache(self.folder / "cache", 10**8)
        rows = np.full((4000, 5), float(version))
        finish(cache.store_steps(f"key{VIEW_STEM_END}", {"version": version}, {"rows": rows}))

    def read(self) -> object:
        cache = ArrayCache(self.folder / "cache", 10**8)
        found = finish(cache.load_steps(f"key{VIEW_STEM_END}", lambda _: True))
        assert found.arrays is not None, found.complaint
        version = _which(found.arrays["rows"], np.ones((4000, 5)))
        return version if version == found.header["version"] else found


def kinds(folder: Path) -> list[Kind]:
    """All of them, each with a folder of its own."""
    made: list[Any] = [Picture, Table, Fields, BatchResult, Eigenpairs, FirstViews]
    made += [(MeshFile, suffix) for suffix in writable_suffixes()]
    made += [(PolygonFile, suffix) for suffix in (".csv", ".json")]
    found = []
    for number, one in enumerate(made):
        (own := folder / str(number)).mkdir()
        found.append(one[0](own, one[1]) if isinstance(one, tuple) else one(own))
    return found


def _which(found: NDArray[Any], first: NDArray[Any]) -> object:
    """1 or 2, by which multiple of the first version was found."""
    return next((one for one in (1, 2) if np.array_equal(found, one * first)), found)


def _vtp_points(path: Path) -> NDArray[np.float64]:
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

    reader = vtkXMLPolyDataReader()
    reader.SetFileName(str(path))
    reader.Update()
    return vtk_to_numpy(reader.GetOutput().GetPoints().GetData()).astype(np.float64)


def kill_while_it_writes(kind: Kind, seconds: float) -> None:
    """Have another process write for some seconds, and kill it."""
    read_end, write_end = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            kind.write(1)
            os.write(write_end, b"!")
            while True:
                for version in (2, 1):
                    kind.write(version)
        finally:
            os._exit(1)
    os.close(write_end)
    os.read(read_end, 1)
    os.close(read_end)
    time.sleep(seconds)
    os.kill(child, signal.SIGKILL)
    _, status = os.waitpid(child, 0)
    if not os.WIFSIGNALED(status):
        raise RuntimeError(f"the writer of {kind.name} ended by itself")


def run(kills: int, seed: int) -> dict[str, Any]:
    """So many kills, shared out among the kinds: versions found, writes cut off, and what is wrong."""
    rng, wrong, cut_off, versions = np.random.default_rng(seed), [], 0, {"1": 0, "2": 0}
    with tempfile.TemporaryDirectory() as name:
        all_kinds = kinds(Path(name))
        for number in range(kills):
            kind = all_kinds[number % len(all_kinds)]
            before = len(_parts(kind.folder))
            kill_while_it_writes(kind, rng.uniform(0, LONGEST_SECONDS))
            cut_off += len(_parts(kind.folder)) - before
            try:
                version = kind.read()
            except Exception as error:
                version = repr(error)
            if version in (1, 2):
                versions[str(version)] += 1
            else:
                wrong.append(f"{kind.name}: {str(version)[:300]}")
    return {"kills": kills, "cut_off": cut_off, "versions": versions, "wrong": wrong}


def _parts(folder: Path) -> list[Path]:
    return list(folder.rglob(f"*{PART_SUFFIX}"))


def main() -> int:
    """Print what came of it as JSON; 1 if a file was neither the old one nor the new one."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--kills", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=2009)
    given = parser.parse_args()
    told = run(given.kills, given.seed)
    print(json.dumps(told))
    return 1 if told["wrong"] else 0


if __name__ == "__main__":
    sys.exit(main())
