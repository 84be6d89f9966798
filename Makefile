# `make help` lists the targets. Everything runs in .venv, which `make setup` makes and every target asks for.
MAKEFLAGS += --no-print-directory
RUN := tools/run.sh
PARTS := cases results numerics joints dem continuum compare
# Reports and tests start Python many times: none compiles the sources anew, whatever the environment says.
export PYTHONDONTWRITEBYTECODE :=
# Each process takes neighbouring tests, which share kernels and fixtures. Scenes come last: else those of large elements run beside those
# of the browser, and both together take 5 GB.
TESTS := $(RUN) python -m pytest -n auto --maxprocesses 8 --dist worksteal --junitxml out/tests.xml

.DEFAULT_GOAL := help
.PHONY: help setup demo test test-all docs gallery check types fuzz bench bench-peers lock test-lowest test-wheel clean distclean

help:  ## this list
	@awk -F ':.*## ' '/^[a-z0-9-]+:.*## / { printf "make %-14s %s\n", $$1, $$2 }' Makefile

setup:  ## .venv with dolfinx and this project: from the active environment, apt or pip (LOCKED=1: constraints.txt's versions)
	@tools/setup.sh

demo: setup  ## the paper's figures and all studies as one page, report/index.html
	@$(RUN) jointwave report --out report

test:  ## all tests, and every shipped scene checked against its bounds
	@tools/setup.sh browser
	@$(TESTS) tests cases

test-all:  ## make test with the slow tests, the longest hard cases
	@tools/setup.sh browser
	@$(TESTS) -m "slow or not slow" tests cases

docs:  ## the documentation as pages, site/index.html; writes docs/reference
	@tools/setup.sh docs
	@$(RUN) python tools/docs/hooks.py
	@$(RUN) python tools/docs/notebooks.py
	@NO_MKDOCS_2_WARNING=1 $(RUN) python -m mkdocs build --strict

gallery: setup  ## the pictures of docs/gallery, each from the scene and the lines beside it
	@$(RUN) python tools/docs/gallery.py

fuzz: setup  ## bad scenes, loads, curves, studies, meshes and commands, twenty times as many as in make test, others in each run
	@FUZZ=20 $(RUN) python -m pytest tests/fuzz

check: setup  ## lint, formatting, types, and the direction of imports
	@$(RUN) ruff check
	@$(RUN) ruff format --check
	@$(MAKE) types

# Both tools look for packages in folders: they read a copy of the tree as it is installed.
types:
	@rm -rf out/tree && mkdir -p out/tree && cp -r jointwave out/tree && cp -r $(PARTS) out/tree/jointwave
	@MYPYPATH=out/tree $(RUN) mypy
	@cd out/tree && ../../$(RUN) lint-imports --config ../../pyproject.toml

bench: setup  ## both engines: start-up, kernels compared with bare loops and other solvers, threads, MPI
	@$(RUN) python tools/bench

bench-peers: setup  ## the same pillar in LAMMPS and Akantu, a lattice in LAMMPS, installed separately in .peers, compared with ours
	@$(RUN) python tools/peers

.uv/bin/uv:
	@python3 -m venv .uv
	@.uv/bin/python -m pip install -q uv

lock: .uv/bin/uv  ## regenerate constraints.txt: the newest versions, for numpy 1 (Python 3.11) and for numpy 2
	@.uv/bin/uv pip compile -q pyproject.toml --all-extras --universal --upgrade --no-annotate --custom-compile-command 'make lock' -o constraints.txt

test-lowest: setup .uv/bin/uv  ## make test with the oldest versions allowed by pyproject.toml, in .lowest
	@tools/setup.sh browser
	@.venv/bin/python -m venv --clear --system-site-packages .lowest
	@.uv/bin/uv pip install -q --python .lowest/bin/python --resolution lowest-direct --only-binary :all: -e '.[test,check,view,examples]'
	@VENV=.lowest $(TESTS) --junitxml out/lowest.xml tests cases

test-wheel:  ## the wheel in an empty environment of $PYTHON (default python3): compare, report, MPI, scenes as tests
	@tools/test-wheel.sh

clean:  ## remove reports and caches
	rm -rf report site build dist *.egg-info .pytest_cache .hypothesis .mypy_cache .ruff_cache .import_linter_cache
	find $(PARTS) tests -name __pycache__ -prune -exec rm -rf {} +

distclean: clean  ## remove .venv and the other codes too
	rm -rf .venv .lowest .uv .peers
