"""Stress waves in jointed rock by two engines, compared with exact solutions: the Python interface.

    import jointwave as jw

    scene = jw.load("guo-li-2002/fig-03")
    blocks, rock = jw.simulate(scene, "dem"), jw.simulate(scene, "continuum-jointed")
    print(jw.misfit(blocks, rock))

Results are xarray Datasets in SI units, compression positive. `__init__.pyi` lists the public names
with their modules and types; a module is imported when one of its names is first used.
"""

import ast
from importlib import import_module
from pathlib import Path

import jointwave.compare

del jointwave.compare  # the public name is the function; the package can still be imported

_stub = ast.parse(Path(__file__).with_suffix(".pyi").read_text(encoding="utf-8"))
_modules = {
    name.name: found.module
    for found in _stub.body
    if isinstance(found, ast.ImportFrom)
    for name in found.names
}
__all__ = sorted(_modules)


def __dir__():
    return __all__


def __getattr__(name):
    if name not in _modules:
        raise AttributeError(f"module 'jointwave' has no attribute {name!r}")
    if name in ("simulate", "compare"):
        import_module("jointwave.accessor")  # registers `result.jw`
    return getattr(import_module(_modules[name]), name)
