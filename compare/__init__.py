"""Comparison of the engines: exact solutions, misfits, experiments, figures and the report.

`compare.compare(scene)` solves a scene by all that applies and measures every pair. Each name is
imported when it is first used: a run of the rigid blocks loads nothing of the rest.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from compare import engines, scenes
    from compare.engines import applies, names, solve
    from compare.experiments.fit.fit import Fit, fit
    from compare.experiments.planner.planner import plan
    from compare.misfit.external import read_curves
    from compare.misfit.metrics import distance
    from compare.misfit.pairs import Comparison, compare, measure
    from compare.scenes import find, shipped

__all__ = [
    "Comparison",
    "Fit",
    "applies",
    "compare",
    "distance",
    "engines",
    "find",
    "fit",
    "measure",
    "names",
    "plan",
    "read_curves",
    "scenes",
    "shipped",
    "solve",
]

#: By module, the functions and classes that are the package's own.
_OWN = {
    "engines": ("applies", "names", "solve"),
    "experiments.fit.fit": ("Fit", "fit"),
    "experiments.planner.planner": ("plan",),
    "misfit.external": ("read_curves",),
    "misfit.metrics": ("distance",),
    "misfit.pairs": ("Comparison", "compare", "measure"),
    "scenes": ("find", "shipped"),
}
_MODULE_OF = {name: module for module, names in _OWN.items() for name in names}


def __getattr__(name: str) -> Any:
    if name not in __all__:
        raise AttributeError(f"module 'compare' has no attribute {name!r}")
    if name not in _MODULE_OF:
        return import_module(f"compare.{name}")
    return getattr(import_module(f"compare.{_MODULE_OF[name]}"), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
