"""Kernels as plain Python: what numba compiles is cached, and would be taken unchanged."""

import importlib.abc
import importlib.util
from importlib.machinery import SourceFileLoader
from pathlib import Path
from types import CodeType, ModuleType, SimpleNamespace

import numpy

#: What stands for modules that only numba can compile.
SOURCES = {
    "numerics.jit": """
def jitted(function):
    return function

def jitted_for(*effects):
    return jitted

inlined = jitted
""",
    "joints.formula": """
def formula(function):
    return function

flags = formula
""",
    "numerics.denormals": """
def flush_tiny():
    return 0

def restore_tiny(old):
    pass
""",
    "numerics.atomic": """
def peek(counters, i):
    return counters[i]

def post(counters, i, value):
    counters[i] = value

def give_way():
    pass
""",
    "continuum.space.simd": """
WIDTH = 8

def multiply_tile(start, column, value, x, y, factor, at, width, first, size):
    for i in range(size):
        total = 0.0
        for k in range(start[first + i], start[first + i + 1]):
            here = at + int(column[k]) * width
            total = total + value[k] * x[here : here + width]
        y[at + i * width : at + (i + 1) * width] = factor * total

def multiply_pair(column, value, x, y, factor, at, row, first, last, begin):
    at, row, first, last, begin = int(at), int(row), int(first), int(last), int(begin)
    own, sums = x[row : row + 2], None
    for k in range(first, last):
        block, place = value[begin + 4 * (k - begin) :][:4].reshape(2, 2), at + int(column[k])
        terms = block * x[place : place + 2, None]
        sums = terms if sums is None else sums + terms
        if k > first:
            y[place : place + 2] += factor * (block * own).sum(axis=1)
    return tuple(sums.ravel())
""",
}
#: Modules that count without a sign for the compiler's sake: numpy 1 makes a float, which indexes
#: nothing, of the sum of such a number and one of Python's.
UNSIGNED = {f"continuum.space.{name}": {"ONE": 1, "TWO": 2} for name in ("operator", "stencils")}
PACKAGES = ("cases", "results", "numerics", "joints", "dem", "continuum", "compare")


class Finder(importlib.abc.MetaPathFinder):
    """Finds the project's own modules below a folder."""

    def __init__(self, root: Path):
        self.root = root

    def find_spec(self, name: str, path=None, target=None):
        if name.split(".")[0] not in PACKAGES:
            return None
        base = self.root.joinpath(*name.split("."))
        file = base / "__init__.py" if base.is_dir() else base.with_suffix(".py")
        if not file.exists():
            return None
        return importlib.util.spec_from_file_location(name, file, loader=Loader(name, str(file)))


class Loader(SourceFileLoader):
    """Loads a module, or what stands for it."""

    def get_code(self, name: str) -> CodeType:
        """Return the code of the module, or of what stands for it."""
        if name in SOURCES:
            return compile(SOURCES[name], self.path, "exec")
        return super().get_code(name)

    def exec_module(self, module: ModuleType) -> None:
        """Execute it."""
        super().exec_module(module)
        if module.__name__ in UNSIGNED:
            signed = SimpleNamespace(**vars(numpy) | {"uint64": numpy.int64})
            vars(module).update(UNSIGNED[module.__name__], np=signed)
