"""What the code takes from libraries: their public sides, and nothing of theirs is replaced."""

import ast
import os
import shutil
import subprocess
import sys
from functools import cache
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
PACKAGES = "cases", "results", "numerics", "joints", "dem", "continuum", "compare", "jointwave"
FILES = sorted(str(p.relative_to(ROOT)) for name in PACKAGES for p in (ROOT / name).rglob("*.py"))
PRIVATE = ("numba.core", "numba._", "numba.np", "llvmlite")

#: One intrinsic that flushes denormals, and what kernels of the present engines rest on. This list
#: may only shrink.
COMPILER_INSIDE = {
    "numerics/denormals.py",
}
#: Settings that a library documents as such.
SETTINGS = {"numba.config.CACHE_DIR"}
MOST_ARGUMENTS = 12


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


def test_the_inside_of_the_compiler_is_imported_by_few():
    """A file that no longer imports it leaves the list."""
    found = {file for file in FILES if any(name.startswith(PRIVATE) for name, _ in imported(file))}
    assert found == COMPILER_INSIDE


def test_dolfinx_and_what_it_loads_are_imported_in_one_place():
    """pip's libraries find one another only in that order."""
    loaded = ("dolfinx", "petsc4py", "mpi4py.MPI")
    found = {
        file
        for file in FILES
        if any(
            f"{name}.".startswith(tuple(f"{one}." for one in loaded)) for name, _ in imported(file)
        )
    }
    assert found == {"continuum/space/fenicsx.py", "compare/runs/processes.py"}


def test_no_array_is_asked_for_what_numpy_2_took_away():
    gone = {"ptp", "itemset", "newbyteorder"}
    for file in FILES:
        for node in nodes(file):
            if isinstance(node, ast.Attribute) and node.attr in gone:
                assert ast.unparse(node.value) == "np", f"{file}:{node.lineno}"


@pytest.mark.parametrize("package", PACKAGES)
def test_no_attribute_of_a_library_is_replaced(package):
    for file in FILES:
        if file.startswith(f"{package}/"):
            assert set(replaced(file)) <= SETTINGS, file


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


def test_functions_have_few_arguments():
    found = set()
    for file in FILES:
        for node in nodes(file):
            if isinstance(node, ast.FunctionDef):
                given = node.args
                if len(given.posonlyargs + given.args + given.kwonlyargs) > MOST_ARGUMENTS:
                    found.add((file, node.name))
    assert not found


def test_no_module_imports_one_that_imports_it():
    """Nor inside functions, nor for type checkers."""
    modules = {file: f"jointwave.{file[:-3]}".replace("/", ".") for file in FILES}
    modules = {file: name.removesuffix(".__init__") for file, name in modules.items()}
    graph = {}
    for file, own in modules.items():
        names = {part for name, _ in imported(file) for part in (name, name.rpartition(".")[0])}
        graph[own] = names & {*modules.values()} - {own}
    TopologicalSorter(graph).prepare()  # raises CycleError


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
