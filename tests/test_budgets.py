"""Budgets that keep the house one to find one's way in: sizes, docstrings, examples, constants, faces."""

from __future__ import annotations

import ast
import re
from collections import defaultdict
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
CORE = ROOT / "src" / "idviewer" / "core"
LINES, BODY, PARAMETERS, EXAMPLES = 300, 60, 6, 0.5
"""Of a file; of a function; and the share of the core's public functions with an example."""

FOLDERS = ("src", "tests", "benchmarks", "docs", "examples", "assets", "scripts")
Function = ast.FunctionDef | ast.AsyncFunctionDef


def python_files(*folders: str) -> list[Path]:
    return sorted(path for folder in folders for path in (ROOT / folder).rglob("*.py"))


@cache
def tree_of(path: Path) -> ast.Module:
    return ast.parse(path.read_text(), str(path))


def place(path: Path, line: int = 1) -> str:
    return f"{path.relative_to(ROOT)}:{line}"


def functions_of(path: Path) -> Iterator[Function]:
    return (node for node in ast.walk(tree_of(path)) if isinstance(node, Function))


def is_kernel(path: Path) -> bool:
    return CORE / "_kernels" in path.parents


def public_functions(path: Path) -> Iterator[tuple[str, Function]]:
    """Functions and methods whose names, and whose class's, begin with a letter, by qualified name."""
    for node in tree_of(path).body:
        if isinstance(node, Function) and not node.name.startswith("_"):
            yield node.name, node
        elif isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
            for inner in node.body:
                if isinstance(inner, Function) and not inner.name.startswith("_"):
                    yield f"{node.name}.{inner.name}", inner


def core_functions() -> Iterator[tuple[Path, str, Function]]:
    """The public ones of modules of the core that are no kernels."""
    for path in python_files("src/idviewer/core"):
        if not is_kernel(path):
            yield from ((path, name, node) for name, node in public_functions(path))


def parameters_of(node: Function) -> list[str]:
    named = [*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs]
    return [one.arg for one in named if one.arg not in ("self", "cls")]


def files_too_long() -> Iterator[str]:
    for path in python_files(*FOLDERS):
        if (lines := path.read_text().count("\n")) > LINES:
            yield f"{place(path)}: {lines} lines, of at most {LINES}"


def bodies_too_long() -> Iterator[str]:
    for path in python_files(*FOLDERS):
        for node in functions_of(path):
            lines = (node.end_lineno or 0) - node.body[0].lineno + 1
            if lines > BODY:
                yield f"{place(path, node.lineno)}: {node.name} has {lines} lines, of at most {BODY}"


def too_many_parameters() -> Iterator[str]:
    for path in python_files(*FOLDERS):
        for node in () if is_kernel(path) else functions_of(path):
            if (count := len(parameters_of(node))) > PARAMETERS:
                yield f"{place(path, node.lineno)}: {node.name} takes {count} of {PARAMETERS} parameters"


def raises(node: Function) -> bool:
    """Whether it raises an error itself, outside of functions in it."""
    todo: list[ast.AST] = list(node.body)
    while todo:
        one = todo.pop()
        if isinstance(one, ast.Raise) and one.exc is not None:
            named = one.exc.func if isinstance(one.exc, ast.Call) else one.exc
            if not (isinstance(named, ast.Name) and named.id in ("NotImplementedError", "AssertionError")):
                return True
        if not isinstance(one, Function | ast.Lambda | ast.ClassDef):
            todo += ast.iter_child_nodes(one)
    return False


def docstrings_that_keep_silent() -> Iterator[str]:
    for path, name, node in core_functions():
        text = ast.get_docstring(node) or ""
        if not text:
            if not node.decorator_list:
                yield f"{place(path, node.lineno)}: {name} has no docstring"
            continue
        untold = [one for one in parameters_of(node) if not re.search(rf"\b{one}\b", text)]
        if untold and len(parameters_of(node)) > 1:
            yield f"{place(path, node.lineno)}: the docstring of {name} says nothing of {', '.join(untold)}"
        if raises(node) and "Raises:" not in text:
            yield f"{place(path, node.lineno)}: {name} raises, and its docstring has no Raises:"


def examples_missing() -> Iterator[str]:
    lacking: list[str] = []
    total = 0
    for path in python_files("src/idviewer/core"):
        if is_kernel(path):
            continue
        for node in tree_of(path).body:
            if isinstance(node, Function | ast.ClassDef) and not node.name.startswith("_"):
                total += 1
                if ">>>" not in (ast.get_docstring(node) or ""):
                    lacking.append(f"{place(path, node.lineno)}: {node.name} has no example")
    if len(lacking) > (1.0 - EXAMPLES) * total:
        yield f"src/idviewer/core: {total - len(lacking)} of {total} public names have an example"
        yield from lacking


def constants_of_two_meanings() -> Iterator[str]:
    met: dict[str, dict[str, str]] = defaultdict(dict)
    for path in python_files("src"):
        for node in tree_of(path).body:
            if isinstance(node, ast.Assign | ast.AnnAssign) and node.value is not None:
                targets = node.targets if isinstance(node, ast.Assign) else [node.target]
                for target in targets:
                    if isinstance(target, ast.Name) and target.id.isupper():
                        met[target.id].setdefault(ast.dump(node.value), place(path, node.lineno))
    for name, places in sorted(met.items()):
        # What each module has of its own by custom.
        if len(places) > 1 and name not in ("LOG", "TITLE"):
            yield f"{', '.join(places.values())}: {name} has {len(places)} values"


def walls_climbed() -> Iterator[str]:
    """Imports of a module of the core from behind its room's face."""
    outside = [path for path in python_files("src", "docs", "examples") if CORE not in path.parents]
    for path in outside:
        for node in ast.walk(tree_of(path)):
            names = (
                [node.module or ""]
                if isinstance(node, ast.ImportFrom)
                else [one.name for one in node.names]
                if isinstance(node, ast.Import)
                else []
            )
            for name in names:
                folder = ROOT / "src" / Path(*name.split("."))
                if name.startswith("idviewer.core.") and name.count(".") > 2 and not folder.is_dir():
                    yield f"{place(path, node.lineno)}: imports {name}, not a face of the core"


RULES = (
    files_too_long,
    bodies_too_long,
    too_many_parameters,
    docstrings_that_keep_silent,
    examples_missing,
    constants_of_two_meanings,
    walls_climbed,
)


@pytest.mark.parametrize("rule", RULES, ids=lambda rule: rule.__name__)
def test_budget(rule) -> None:
    broken = list(rule())
    assert not broken, "\n" + "\n".join(broken)
