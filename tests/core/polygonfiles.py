"""Texts of small polygon files for tests: a square, one with a hole, and drawings."""

from __future__ import annotations

from pathlib import Path

CSV = "0,0\n1,0\n1,1\n0,1\n"
RING = "0 0, 1 0, 1 1, 0 1, 0 0"
HOLED = "0,0\n4,0\n4,4\n0,4\n{}1,1\n2,1\n2,2\n1,2\n"


def drawing(body: str, attributes: str = "") -> str:
    return f'<?xml version="1.0"?>\n<svg xmlns="http://www.w3.org/2000/svg" {attributes}>\n{body}\n</svg>\n'


def path(data: str, more: str = "") -> str:
    return drawing(f'<path {more} d="{data}"/>')


def written(folder: Path, name: str, content: str | bytes) -> Path:
    file = folder / name
    file.write_bytes(content.encode() if isinstance(content, str) else content)
    return file
