"""What the code takes from libraries: their public sides, and nothing of theirs is replaced."""

import ast
import os
import shutil
import subprocess
import sys
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parent.parent
PACKAGES = "cases", "results", "numerics", "joints", "dem", "continuum", "compare", "jointwave"
FILES = sorted(str(p.relative_to(ROOT)) for name in PACKAGES for p in (ROOT / name).rglob("*.py"))
PRIVATE = ("numba.core", "numba._", "numba.np", "llvmlite")

COMPILER_INSIDE = {"numerics/denormals.py"}  # one intrinsic that flushes denormals
#: Settings that a library documents as such.
SETTINGS = {"numba.config.CACHE_DIR", "numba.config.THREADING_LAYER_PRIORITY"}
MOST_ARGUMENTS = 12
GONE = {"ptp", "itemset", "newbyteorder"}  # of arrays


@cache
def nodes(file):
    """Return the nodes of a file's syntax tree."""
    return list(ast.walk(ast.parse((ROOT / file).read_text())))


def imported(file):
    """Yield the full name of each imported thing, and the name that it has in the file."""
    for node in nodes(file):
        if isinstance(node, ast.Import):
            for one in node.names:
                yield one.name, one.asname or one.name.split(".")[0]
        elif isinstance(node, ast.ImportFrom) and node.module:
            for one in node.names:
                yield f"{node.module}.{one.name}", one.asname or one.name


def importing(*names):
    """Return the files that import any of these modules, or a part of one."""
    return {f for f in FILES if any(f"{name}.".startswith(names) for name, _ in imported(f))}


def test_few_files_import_what_is_delicate():
    """A file that no longer does leaves its list. pip's libraries of dolfinx find one another only
    where they are loaded in one order."""
    assert importing(*PRIVATE) == COMPILER_INSIDE
    found = importing("dolfinx.", "petsc4py.", "mpi4py.MPI.")
    assert found == {"continuum/space/fenicsx.py", "compare/runs/processes.py"}


def test_functions_have_few_arguments_and_ask_arrays_for_nothing_that_numpy_2_took_away():
    for file in FILES:
        for node in nodes(file):
            if isinstance(node, ast.FunctionDef):
                given = node.args
                count = len(given.posonlyargs + given.args + given.kwonlyargs)
                assert count <= MOST_ARGUMENTS, f"{file}:{node.lineno}"
            if isinstance(node, ast.Attribute) and node.attr in GONE:
                assert ast.unparse(node.value) == "np", f"{file}:{node.lineno}"


def test_no_attribute_of_a_library_is_replaced():
    assert not {(file, name) for file in FILES for name in {*replaced(file)} - SETTINGS}


def replaced(file):
    """Yield the dotted names of what a file assigns to in libraries."""
    ours = {"jointwave", *sys.stdlib_module_names}
    foreign = {own for name, own in imported(file) if name.split(".")[0] not in ours}
    for node in nodes(file):
        if isinstance(node, ast.Attribute) and not isinstance(node.ctx, ast.Load):
            name = node
        elif isinstance(node, ast.Call) and ast.unparse(node.func) in ("setattr", "delattr"):
            name = node.args[0]
        else:
            continue
        if root(name) in foreign:
            yield ast.unparse(name)


def root(node):
    """Return the name that a dotted name begins with, None for anything else."""
    while isinstance(node, ast.Attribute):
        node = node.value
    return node.id if isinstance(node, ast.Name) else None


def test_no_module_imports_one_that_imports_it():
    """Nor inside functions, nor for type checkers."""
    modules = {file: f"jointwave.{file[:-3]}".replace("/", ".") for file in FILES}
    modules = {file: name.removesuffix(".__init__") for file, name in modules.items()}
    graph = {}
    for file, own in modules.items():
        names = {part for name, _ in imported(file) for part in (name, name.rpartition(".")[0])}
        graph[own] = names & {*modules.values()} - {own}
    while leaves := {own for own, names in graph.items() if not names & graph.keys()}:
        graph = {own: names for own, names in graph.items() if own not in leaves}
    assert not graph  # has each circle, and the modules that import one of it


def test_imports_follow_the_layers(tmp_path):
    """Engines never import each other, exact solutions neither engine, nothing imports compare."""
    for name in PACKAGES:  # as they are installed
        here = tmp_path if name == "jointwave" else tmp_path / "jointwave"
        shutil.copytree(ROOT / name, here / name, dirs_exist_ok=True)
    options = "--config", str(ROOT / "pyproject.toml"), "--no-cache"
    lint = "from importlinter.cli import lint_imports_command as lint; lint()"
    done = subprocess.run(
        [sys.executable, "-c", lint, *options],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(tmp_path)},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stdout
