"""Kernels as plain Python: what numba compiles is cached, and would be taken unchanged."""

import importlib.abc
import importlib.util
from importlib.machinery import SourceFileLoader
from pathlib import Path
from types import CodeType, ModuleType

#: What stands for modules that only numba can compile.
SOURCES = {
    "joints.jit": """
def jitted(function):
    return function

apart = inlined = jitted
""",
    "joints.borrowed": """
def borrowed(value):
    return value
""",
    "joints.tiny": """
def flush_tiny():
    return 0

def restore_tiny(old):
    pass
""",
    "joints.atomic": """
def peek(counters, i):
    return counters[i]

def post(counters, i, value):
    counters[i] = value

def give_way():
    pass
""",
    "continuum.space.lanes": """
import numpy as np

WIDTH = 8

def zero(n):
    return np.zeros(WIDTH * n)

def load(like, x, i):
    return x[i : i + like.size].copy()

def store(x, i, lanes):
    x[i : i + lanes.size] = lanes

def add_scaled(lanes, factor, other):
    return lanes + factor * other
""",
}
PACKAGES = ("cases", "joints", "dem", "continuum", "compare")


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
        """Execute it; what it overloads for numba is called by its plain name."""
        super().exec_module(module)
        if module.__name__ == "dem.spatial.points":
            module.every_point = module.looped_points
