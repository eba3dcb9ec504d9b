"""Eigenpairs kept between calls of the command line."""

from __future__ import annotations

from pathlib import Path

import pytest
import trimesh
from tests.cli.commands import Run

from idviewer.session import array_cache, spectrum_cache
from idviewer.session import eigenpair_source as eigenpairs


class TestCache:
    """Eigenpairs are kept from one call to the next."""

    VERBS = (
        ("barycentroid",),
        ("distance", "--from=0,0,0", "--to=0.1,0.2,1"),
        ("render", "out.png", "--size=64x64"),
    )

    @pytest.fixture
    def body(self, tmp_path: Path) -> str:
        """Small enough to take no time."""
        path = tmp_path / "ball.off"
        trimesh.creation.icosphere(subdivisions=1, radius=2).export(path)
        return str(path)

    @pytest.fixture
    def folder(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
        """Where they are; also those that took no time."""
        monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
        monkeypatch.setattr(spectrum_cache.SpectrumCache.__init__, "__defaults__", (10**9, 0.0))
        return tmp_path / "idviewer" / "eigenpairs"

    @pytest.mark.parametrize("verb", VERBS)
    def test_what_was_computed_once_is_read(
        self, run: Run, body: str, folder: Path, verb: tuple[str, ...], monkeypatch: pytest.MonkeyPatch
    ) -> None:
        first = run(verb[0], body, *verb[1:])
        assert [path.suffix for path in folder.iterdir()] == [array_cache.SUFFIX]
        monkeypatch.delattr(eigenpairs, "eigenpair_steps")
        assert run(verb[0], body, *verb[1:]) == first
        assert first.status == 0

    @pytest.mark.slow
    @pytest.mark.parametrize("verb", VERBS)
    def test_no_cache_neither_reads_nor_writes(
        self, run: Run, body: str, folder: Path, verb: tuple[str, ...]
    ) -> None:
        first = run(verb[0], body, *verb[1:], "--no-cache")
        assert not folder.exists()
        run("barycentroid", body)
        (path,) = folder.iterdir()
        path.write_text("damaged")
        assert run(verb[0], body, *verb[1:], "--no-cache") == first
        assert path.read_text() == "damaged"

    @pytest.mark.slow
    @pytest.mark.parametrize("verb", VERBS)
    def test_damage_is_told(self, run: Run, body: str, folder: Path, verb: tuple[str, ...]) -> None:
        run("barycentroid", body)
        (path,) = folder.iterdir()
        path.write_bytes(path.read_bytes()[:5000])
        told = run(verb[0], body, *verb[1:])
        assert told.status == 0
        assert told.err.splitlines() == [
            "idviewer: The eigenpairs kept of this shape were computed again: their file was damaged."
        ]
        assert run("barycentroid", body).err == ""

    @pytest.mark.parametrize("verb", ["render", "distance", "barycentroid", ""])
    def test_it_is_in_the_help(self, run: Run, verb: str) -> None:
        assert "--no-cache" in run(*verb.split(), "--help").out
