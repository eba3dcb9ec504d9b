"""What all tests share: seeded random numbers, repeatable hypothesis, and no need of Qt without windows."""

from __future__ import annotations

import dataclasses
import importlib.util
import math
import os
import sys
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path

import hypothesis
import numpy as np
import pytest

SEED = 20090715
"""Of all random numbers, unless `--hypothesis-seed` gives another."""

hypothesis.settings.register_profile("repeatable", derandomize=True, deadline=None)
hypothesis.settings.register_profile("seeded", deadline=None)
hypothesis.settings.load_profile("repeatable")

CORE = Path(__file__).parents[1] / "src" / "idviewer" / "core"
CACHES = Path(__file__).parents[1] / ".numba_cache"


os.environ.setdefault("NUMBA_CACHE_DIR", str(CACHES))  # before anything imports numba

OPTIONS_OF = {
    "pytestqt": ["qt_api"],
    "pytest_xvfb": ["xvfb_width", "xvfb_height", "xvfb_colordepth"],
}
"""Settings in pyproject.toml that belong to the plugins which drive windows."""


def pytest_addoption(parser: pytest.Parser) -> None:
    """Lets the settings of the window plugins stand where these are not installed (`make test-core`)."""
    for plugin, names in OPTIONS_OF.items():
        if importlib.util.find_spec(plugin) is None:
            for name in names:
                parser.addini(name, f"of {plugin}, which is not installed")


def pytest_configure(config: pytest.Config) -> None:
    """Has hypothesis heed a seed that is given, which it does not where all runs draw the same."""
    if config.getoption("hypothesis_seed") is not None:
        hypothesis.settings.load_profile("seeded")


def seed_of(config: pytest.Config) -> int:
    """The number after `--hypothesis-seed`, which holds for the `rng` fixture too."""
    return int(config.getoption("hypothesis_seed") or SEED)


def is_silent(config: pytest.Config) -> bool:
    """Whether nothing but failures and the closing line are wanted: with -q, where nobody watches."""
    reporter = config.pluginmanager.get_plugin("terminalreporter")
    return config.get_verbosity() < 0 and reporter is not None and not reporter.isatty


@pytest.hookimpl(tryfirst=True)
def pytest_sessionstart(session: pytest.Session) -> None:
    """Has xdist not tell twice that it brings up nodes, which it does with -q too."""
    reporter = session.config.pluginmanager.get_plugin("terminaldistreporter")
    if reporter is not None and is_silent(session.config):
        reporter.ensure_show_status = lambda: None


@pytest.hookimpl(tryfirst=True)
def pytest_report_teststatus(report: pytest.TestReport, config: pytest.Config) -> tuple[str, str, str] | None:
    """Spares the dots."""
    return ("passed", "", "") if report.passed and report.when == "call" and is_silent(config) else None


def pytest_terminal_summary(
    terminalreporter: pytest.TerminalReporter, exitstatus: int, config: pytest.Config
) -> None:
    """Says after failures which random numbers they had, and how to have them again."""
    if exitstatus == pytest.ExitCode.TESTS_FAILED:
        given = config.getoption("hypothesis_seed") is not None
        option = f"--hypothesis-seed={seed_of(config)} " if given else ""
        same = "" if given else ", hypothesis derandomized: the same in every run"
        terminalreporter.write_line(f"Seed of the random numbers: {seed_of(config)}{same}.")
        terminalreporter.write_line(f'To repeat a failure: make test PYTEST_ARGS="{option}NAME"')


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item: pytest.Item) -> Iterator[object]:
    """Has boundaries computed on as they are given, without a word on it, but in tests marked `refined`.

    Most tests hold results on small bodies against twins on the same vertices; examples in docstrings show
    what users have. Not a fixture: those of modules are made before any of a test.
    """
    from idviewer.core.interior import discretisation_error
    from idviewer.core.spectrum import resolution

    usual = resolution.RESOLUTION, discretisation_error.DISCRETISATION
    if Path(__file__).parent in item.path.parents and item.get_closest_marker("refined") is None:
        resolution.RESOLUTION = dataclasses.replace(usual[0], tolerated=math.inf)
        discretisation_error.DISCRETISATION = dataclasses.replace(usual[1], serious=math.inf)
    try:
        return (yield)
    finally:
        resolution.RESOLUTION, discretisation_error.DISCRETISATION = usual


@pytest.fixture(scope="session")
def locks(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of files that processes lock; it is the same for all that share out the tests."""
    folder = tmp_path_factory.getbasetemp().parent / "locks"
    folder.mkdir(exist_ok=True)
    return folder


@pytest.fixture(scope="session", autouse=True)
def own_caches(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Keeps eigenpairs that programs under test store, and those of the user, apart from each other.

    What matplotlib and Mesa keep has nothing to do with it, and takes long to make again.
    """
    users = os.environ.get("XDG_CACHE_HOME") or str(Path.home() / ".cache")
    os.environ.setdefault("MPLCONFIGDIR", os.path.join(users, "matplotlib"))
    os.environ.setdefault("MESA_SHADER_CACHE_DIR", users)
    folder = tmp_path_factory.mktemp("caches")
    os.environ["XDG_CACHE_HOME"] = str(folder)
    return folder


MANY = 1000


@pytest.fixture(scope="session", autouse=True)
def compiled(request: pytest.FixtureRequest, own_caches: Path, locks: Path) -> None:
    """Compiles the largest kernels on two cores before many tests, which would come to them one by one."""
    if request.session.testscollected > MANY:
        from idviewer.core.compilation import compile_steps
        from idviewer.core.steps import finish

        with (locks / "compiling").open("w") as file:
            with suppress(ImportError):  # there is none on Windows, where each process compiles for itself
                import fcntl

                fcntl.flock(file, fcntl.LOCK_EX)  # where there are two processes, one does it
            finish(compile_steps(3))


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Marks as slow all but the first of a test's parameters where one of them is enough for `make check`."""
    met: set[str] = set()
    for item in items:
        if item.get_closest_marker("one_is_quick") and not item.get_closest_marker("slow"):
            test = item.nodeid.partition("[")[0]
            if test in met:
                item.add_marker(pytest.mark.slow)
            met.add(test)


@pytest.fixture
def rng(pytestconfig: pytest.Config) -> np.random.Generator:
    """Random numbers that are the same in every test, and in every run with the same seed."""
    return np.random.default_rng(seed_of(pytestconfig))


@pytest.fixture
def calls_of() -> Callable[[Callable[[], object]], int]:
    """How many calls of functions, Python's and others, a call makes: what it costs on any machine."""

    def count(call: Callable[[], object]) -> int:
        calls = 0

        def see(_frame: object, event: str, _argument: object) -> None:
            nonlocal calls
            calls += event in ("call", "c_call")

        call()  # what is done the first time only
        outer = sys.getprofile()
        sys.setprofile(see)
        try:
            call()
        finally:
            sys.setprofile(outer)
        return calls

    return count
