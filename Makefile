# `make help` lists the targets. Everything runs in .venv, which `make setup` makes and every target asks for.
MAKEFLAGS += --no-print-directory
RUN := tools/run.sh
# Each process takes neighbouring tests, which share kernels and fixtures. Hundreds of them start Python: none compiles
# the sources anew, whatever the environment says.
TESTS := PYTHONDONTWRITEBYTECODE= $(RUN) python -m pytest -n auto --maxprocesses 8 --dist worksteal --junitxml out/tests.xml

.DEFAULT_GOAL := help
.PHONY: help setup demo test test-all docs check fuzz mutate bench bench-peers bench-plan lock test-lowest test-debian13 test-wheel clean distclean

help:  ## this list
	@awk -F ':.*## ' '/^[a-z0-9-]+:.*## / { printf "make %-14s %s\n", $$1, $$2 }' Makefile

setup:  ## .venv with dolfinx and this project: from the active environment, apt, pip or conda (LOCKED=1: constraints.txt's versions)
	@tools/setup.sh

demo: setup  ## the paper's figures and all studies as one page, report/index.html
	@$(RUN) jointwave report --out report

test:  ## all tests, and every shipped scene held to its own bounds
	@tools/setup.sh browser
	@$(TESTS) tests cases

test-all:  ## make test with the slow tests too: the longest of the hard cases
	@tools/setup.sh browser
	@$(TESTS) -m "slow or not slow" tests cases

docs:  ## the documentation as pages, site/index.html, with the outcomes of the last make test
	@tools/setup.sh docs
	@$(RUN) python tools/docs/notebooks.py
	@NO_MKDOCS_2_WARNING=1 $(RUN) python -m mkdocs build --strict

fuzz: setup  ## 10,000 bad scenes, loads, curves, studies, meshes and commands, made by atheris (installed apart in .fuzz)
	@$(RUN) python tools/fuzz

mutate: setup  ## small faults in the code of cases/ and joints/, each of which a test should find (20 min; others: tools/mutate PATH)
	@$(RUN) python tools/mutate

check: setup  ## lint, formatting, types, and the direction of imports
	@$(RUN) ruff check
	@$(RUN) ruff format --check
	@$(RUN) mypy
	@$(RUN) lint-imports

bench: setup  ## both engines: start-up, kernels against bare loops and other solvers, threads, MPI, memory
	@$(RUN) python tools/bench

bench-peers: setup  ## the same pillar in LAMMPS, Akantu and Yade, a lattice in LAMMPS, installed apart in .peers, beside ours
	@$(RUN) python tools/peers
	@$(RUN) python tools/peers/lattice.py

bench-plan: setup  ## what is planned for every shipped scene, held against all configurations of it (10 min)
	@$(RUN) python tools/plan

.uv/bin/uv:
	@python3 -m venv .uv
	@.uv/bin/python -m pip install -q uv

lock: .uv/bin/uv  ## constraints.txt anew: the newest set of versions, for numpy 1 (Python 3.11) and for numpy 2
	@.uv/bin/uv pip compile -q pyproject.toml --all-extras --universal --upgrade --no-annotate --custom-compile-command 'make lock' -o constraints.txt

test-lowest: setup .uv/bin/uv  ## make test with the oldest versions that pyproject.toml admits, in .lowest
	@tools/setup.sh browser
	@tools/lowest.sh
	@VENV=.lowest $(TESTS) --junitxml out/lowest.xml tests cases

test-debian13:  ## make test in a fresh Debian 13, with pip's dolfinx and with apt's (needs root or sudo)
	@tools/debian13.sh

test-wheel:  ## the wheel in an empty environment of $PYTHON (default python3): compare, report, MPI, scenes as tests
	@tools/test-wheel.sh

clean:  ## remove reports and caches
	rm -rf report site build dist *.egg-info .pytest_cache .hypothesis .mypy_cache .ruff_cache .import_linter_cache
	find cases results numerics joints dem continuum compare tests -name __pycache__ -prune -exec rm -rf {} +

distclean: clean  ## remove .venv, the other codes and the fuzzer too
	rm -rf .venv .lowest .uv .peers .fuzz
