"""How far apart the engines are, why, and what it costs: exact solutions, metrics, report.

`compare.compare(scene)` solves a scene by all that applies and measures every pair. What is named
here is imported when it is first asked for: a run of the rigid blocks loads nothing of it.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from compare import curves, engines, metrics, pairs, planner, scenes
    from compare.curves import read_curves
    from compare.engines import applies, names, solve
    from compare.fitting.fit import Fit, fit
    from compare.metrics import distance, misfit
    from compare.pairs import Comparison, compare, measure
    from compare.planner import plan
    from compare.scenes import find, shipped

__all__ = [
    "Comparison",
    "Fit",
    "applies",
    "compare",
    "curves",
    "distance",
    "engines",
    "find",
    "fit",
    "measure",
    "metrics",
    "misfit",
    "names",
    "pairs",
    "plan",
    "planner",
    "read_curves",
    "scenes",
    "shipped",
    "solve",
]

#: By module, the functions and classes that are the package's own.
_OWN = {
    "curves": ("read_curves",),
    "engines": ("applies", "names", "solve"),
    "fitting.fit": ("Fit", "fit"),
    "metrics": ("distance", "misfit"),
    "pairs": ("Comparison", "compare", "measure"),
    "planner": ("plan",),
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
