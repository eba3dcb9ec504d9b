# `make help` lists the targets. Nothing has to be installed by hand: each target sets up what it needs.

SHELL := /bin/sh
.DEFAULT_GOAL := help
.DELETE_ON_ERROR:
.NOTPARALLEL:

VENV := .venv
PYTHON_IN := $(VENV)/bin/python
INSTALL := $(PYTHON_IN) -m pip --disable-pip-version-check install --quiet
MESH ?=
BENCH_ARGS ?=
FUZZ_ARGS ?=
SOAK_ARGS ?=
PYTEST_ARGS ?=
FIGURES ?=

.PHONY: help run test check lint test-core test-lowest fuzz soak bench pictures figures shapes clean system-run system-test

help: ## this list
	@sed -nE 's/^([a-z-]+):[^#]*## (.*)/  make \1\t\2/p' Makefile | expand -t 18

run: system-run $(VENV)/installed-run ## open the window; MESH=file or a bundled shape's name (no display: writes the picture to a file)
	@$(PYTHON_IN) -m idviewer $(if $(MESH),"$(MESH)")

test: system-test $(VENV)/installed-test ## the whole test suite (PYTEST_ARGS are passed on)
	@OPENBLAS_NUM_THREADS=1 $(PYTHON_IN) -m pytest --quiet --numprocesses 2 --dist worksteal $(PYTEST_ARGS)

check: lint system-test $(VENV)/installed-test ## formatting, lint, types, import contracts and the fast tests, in under a minute
	@OPENBLAS_NUM_THREADS=1 $(PYTHON_IN) -m pytest --quiet --numprocesses 2 --dist worksteal -m "not slow" --ignore=tests/view $(PYTEST_ARGS)

lint: $(VENV)/installed-lint ## formatting, lint, types and import contracts alone
	@$(PYTHON_IN) -m ruff format --check .
	@$(PYTHON_IN) -m ruff check .
	@$(PYTHON_IN) -m mypy
	@$(VENV)/bin/lint-imports

test-core: $(VENV)/core/installed ## core and session in an environment without Qt and PyVista
	@$(VENV)/core/bin/python -m pytest tests/core tests/session tests/test_imports.py src/idviewer/core src/idviewer/session

test-lowest: system-test $(VENV)/lowest/installed ## core, session and pictures with the oldest versions that pyproject.toml allows
	@OPENBLAS_NUM_THREADS=1 $(VENV)/lowest/bin/python -m pytest -q -m "not slow" tests/core tests/session tests/view/test_images.py

fuzz: system-test $(VENV)/installed-test ## read ten thousand damaged files of all kinds (FUZZ_ARGS are passed on); for the night
	@$(PYTHON_IN) -m tests.fuzz.campaign $(FUZZ_ARGS)

soak: system-test $(VENV)/installed-test ## random events on the window, closes, killed writers (SOAK_ARGS are passed on); for the night
	@$(PYTHON_IN) -m tests.view.soak $(SOAK_ARGS)

bench: system-test $(VENV)/installed-test ## speed, errors and memory, beside peers and bars: tables, and JSON (BENCH_ARGS are passed on)
	@$(PYTHON_IN) benchmarks/run.py $(BENCH_ARGS)

pictures: system-test $(VENV)/installed-test ## draw the pictures of the documentation again
	@$(PYTHON_IN) docs/pictures.py

figures: system-test $(VENV)/installed-test ## do the paper's experiments again: docs/figures.md and its pictures (FIGURES="5 11" for some)
	@cd docs && ../$(PYTHON_IN) -m figures $(FIGURES)

shapes: $(VENV)/installed-shapes ## make the bundled shapes again
	@$(PYTHON_IN) assets/make_shapes.py
	@$(PYTHON_IN) assets/make_polygons.py

clean: ## remove the environments, caches and build products
	rm -rf $(VENV) build dist .pytest_cache .ruff_cache .mypy_cache .import_linter_cache .hypothesis .numba_cache
	find . -name __pycache__ -type d -prune -exec rm -rf {} +

system-run system-test: system-%:
	@scripts/system-libraries $*

# Stamps are touched last, so an interrupted or failed set-up is done again.
$(VENV)/created $(VENV)/core/created $(VENV)/lowest/created: %/created:
	@scripts/system-libraries venv
	@"$$(scripts/find-python)" -m venv $*
	@touch $@

$(VENV)/installed-run: pyproject.toml | $(VENV)/created
	@echo "Installing idviewer and what it needs into $(VENV); a minute or two, once."
	@$(INSTALL) --editable .
	@touch $@

$(VENV)/installed-test $(VENV)/installed-lint $(VENV)/installed-shapes: $(VENV)/installed-%: pyproject.toml | $(VENV)/created
	@echo "Installing idviewer and what its $* targets need into $(VENV); a minute or two, once."
	@$(INSTALL) --editable '.[$*]'
	@touch $@

$(VENV)/core/installed: pyproject.toml scripts/core-requirements | $(VENV)/core/created
	@$(VENV)/core/bin/python scripts/core-requirements | xargs -d '\n' $(VENV)/core/bin/python -m pip --disable-pip-version-check install --quiet
	@$(VENV)/core/bin/python -m pip --disable-pip-version-check install --quiet --no-deps --editable .
	@touch $@

# uv resolves to the lowest versions; what only the tests need is the newest.
$(VENV)/lowest/installed: pyproject.toml | $(VENV)/lowest/created
	@echo "Installing the oldest versions that idviewer works with into $(VENV)/lowest; a minute or two, once."
	@$(VENV)/lowest/bin/python -m pip --disable-pip-version-check install --quiet uv
	@$(VENV)/lowest/bin/uv pip compile --quiet --resolution lowest-direct --python $(VENV)/lowest/bin/python pyproject.toml --output-file $(VENV)/lowest/versions.txt
	@$(VENV)/lowest/bin/uv pip install --quiet --python $(VENV)/lowest/bin/python --constraint $(VENV)/lowest/versions.txt --editable '.[test]'
	@touch $@
