"""The program as a shell sees it: version, help, interrupts, closed pipes."""

from __future__ import annotations

import math
import os
import subprocess
import sys
from pathlib import Path
from typing import get_args, get_type_hints

import pytest
from tests.cli.commands import Run, refused

import idviewer
from idviewer.cli import output, parsing
from idviewer.cli.options import DisplayOptions


class TestProgram:
    def test_version(self, run: Run) -> None:
        assert run("--version") == (0, idviewer.__version__ + "\n", "")

    @pytest.mark.parametrize(
        "verb",
        [
            (),
            ("render",),
            ("distance",),
            ("barycentroid",),
            ("info",),
            ("samples",),
            ("batch",),
            ("compare",),
        ],
    )
    def test_help(self, run: Run, verb: tuple[str, ...]) -> None:
        answer = run(*verb, "--help")
        assert answer.status == 0
        assert " ".join(("Usage: idviewer", *verb)) in answer.out

    def test_unknown_option(self, run: Run) -> None:
        assert "--wiggle" in refused(run("--wiggle"))

    def test_an_interrupt_leaves_no_trace(self, run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
        def interrupt(name: str) -> Path:
            raise KeyboardInterrupt

        monkeypatch.setattr(parsing, "path_of", interrupt)
        assert run("info", "hand") == (130, "", "")

    def test_running_out_of_memory(self, run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
        def exhaust(name: str) -> Path:
            raise MemoryError

        monkeypatch.setattr(parsing, "path_of", exhaust)
        assert "not enough memory" in refused(run("info", "hand"))

    @pytest.mark.slow
    def test_a_reader_that_leaves(self, body: str) -> None:
        reader, writer = os.pipe()
        os.close(reader)
        command = [sys.executable, "-m", "idviewer", "info", body]
        done = subprocess.run(command, stdout=writer, stderr=subprocess.PIPE, check=False)
        os.close(writer)
        assert (done.returncode, done.stderr) == (141, b"")

    def test_colormaps_are_those_of_the_view(self) -> None:
        from idviewer.view.colormaps import COLORMAPS

        assert get_args(get_type_hints(DisplayOptions)["colormap"]) == tuple(COLORMAPS)

    def test_json_has_no_nan(self) -> None:
        assert output.as_json({"a": [1.0, math.inf]}) == '{"a": [1.0, null]}'
