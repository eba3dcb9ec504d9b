"""The paper's experiments: every figure is made, told of and shown, and its numbers have their place."""

from __future__ import annotations

import re
from pathlib import Path
from types import SimpleNamespace

import pytest
from PIL import Image

DOCS = Path(__file__).parents[1] / "docs"
IMAGES = DOCS / "images" / "figures"
NUMBERS = ("1", "3", "4", "5", "6", "7", "8", "9", "10", "11", "12", "13", "14", "table1")
"""Every experiment of the paper. Figure 2 is a sketch of the method."""
TEXT = (DOCS / "figures.md").read_text()


@pytest.fixture
def figures(monkeypatch: pytest.MonkeyPatch) -> SimpleNamespace:
    # The makers of the bundled shapes, which figures.shapes adds itself, but only when it is first imported.
    monkeypatch.syspath_prepend(DOCS.parent / "assets")
    monkeypatch.syspath_prepend(DOCS)
    from figures import document, gallery, registry

    return SimpleNamespace(document=document, gallery=gallery, registry=registry)


def test_no_experiment_is_forgotten(figures: SimpleNamespace) -> None:
    assert tuple(figures.gallery.FIGURES) == NUMBERS
    assert set(figures.registry.FIGURES) == set(NUMBERS)
    assert {path.stem for path in (DOCS / "figures").glob("[!_]*.py")} == {
        *(group.__name__.rpartition(".")[2] for group in figures.gallery.GROUPS),
        *("bending", "document", "flat", "gallery", "registry", "shapes", "solid", "words"),
    }


@pytest.mark.parametrize("number", NUMBERS)
def test_the_document_has_numbers_and_picture(figures: SimpleNamespace, number: str) -> None:
    start, end = figures.document.markers(number)
    assert TEXT.count(start) == TEXT.count(end) == 1
    between = TEXT.split(start)[1].split(end)[0].strip()
    assert between.startswith("| "), "run `make figures`"
    assert len(between.splitlines()) >= 3
    if figures.gallery.FIGURES[number].drawn:
        name = figures.registry.picture_name(number)
        assert f"(images/figures/{name})" in TEXT
        with Image.open(IMAGES / name) as picture:
            assert picture.width >= 700


def test_pictures_are_all_used_and_small() -> None:
    shown = set(re.findall(r"\(images/figures/([^)]+)\)", TEXT))
    assert shown == {path.name for path in IMAGES.iterdir()}
    assert sum(path.stat().st_size for path in IMAGES.iterdir()) < 6e6


def test_numbers_are_put_between_their_markers(figures: SimpleNamespace) -> None:
    starts, ends = zip(*map(figures.document.markers, ("1", "14")), strict=True)
    text = f"a\n{starts[0]}\nold\n{ends[0]}\nb\n{starts[1]}\nkept\n{ends[1]}\n"
    for table in ("new", "newer"):
        text = figures.document.put_into(text, "1", table)
        assert text == f"a\n{starts[0]}\n\n{table}\n\n{ends[0]}\nb\n{starts[1]}\nkept\n{ends[1]}\n"
    with pytest.raises(ValueError, match="put the lines"):
        figures.document.put_into(text, "5", "new")


@pytest.mark.slow
@pytest.mark.timeout(600)  # the first of them may have to compile all kernels
@pytest.mark.parametrize("number", NUMBERS)
def test_figures_are_made(figures: SimpleNamespace, number: str, tmp_path: Path) -> None:
    if number in ("8", "9", "10", "13", "14", "table1"):
        pytest.importorskip("fast_simplification")
    figure = figures.gallery.FIGURES[number]
    table = figure.make(figures.registry.Run(tmp_path, tiny=True))
    assert table.rows
    assert all(len(row) == len(table.header) for row in table.rows)
    assert "nan" not in table.markdown()
    assert [path.name for path in tmp_path.iterdir()] == (
        [figures.registry.picture_name(number)] if figure.drawn else []
    )
