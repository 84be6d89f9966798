"""A scene solved by all that applies to it, and how far apart the solutions are, pair by pair."""

from dataclasses import dataclass, field
from typing import NamedTuple

import xarray as xr

from cases.scene import Scene
from compare.engines import Progress, applies, names, solve
from compare.metrics import Distance, distance


class Pair(NamedTuple):
    """A result, what it is held against, and what their distance means."""

    one: str
    other: str
    kind: str


NUMERICAL = "numerical error"
MODELLING = "modelling error"
ENGINES = "between engines"

PAIRS = (
    # Against the exact solution of the very model that the engine discretises.
    Pair("dem", "lattice", NUMERICAL),
    Pair("dem", "no-tension-chain", NUMERICAL),
    Pair("continuum-jointed", "jointed-bar", NUMERICAL),
    Pair("continuum-equivalent", "equivalent-bar", NUMERICAL),
    Pair("continuum-equivalent", "images", NUMERICAL),
    Pair("continuum-equivalent", "kelvin-voigt", NUMERICAL),
    Pair("series", "images", NUMERICAL),
    # Against the exact solution of a model that resolves more, or homogenises more.
    Pair("dem", "jointed-bar", MODELLING),
    Pair("dem", "equivalent-bar", MODELLING),
    Pair("continuum-equivalent", "jointed-bar", MODELLING),
    Pair("dem", "continuum-jointed", ENGINES),
    Pair("dem", "continuum-equivalent", ENGINES),
    Pair("continuum-equivalent", "continuum-jointed", ENGINES),
)


class Row(NamedTuple):
    """The distance of one pair at one receiver."""

    pair: Pair
    quantity: str
    y: float
    distance: Distance


@dataclass
class Comparison:
    """One variant of a scene, everything that solved it, and why the rest did not.

    results : by name. reasons : name to reason, of what does not apply. rows : the distances.
    """

    scene: Scene
    results: dict[str, xr.Dataset] = field(default_factory=dict)
    reasons: dict[str, str] = field(default_factory=dict)
    rows: list[Row] = field(default_factory=list)


def compare(scene: Scene, progress: Progress | None = None, spectral: bool = False) -> Comparison:
    """Solve a scene by everything that applies to it and measure every pair.

    `progress` is called with the finished fraction; `spectral` adds envelope and phase misfits.
    """
    comparison, everything = Comparison(scene), names()
    for i, name in enumerate(everything):
        answer = applies(name, scene)
        if answer:
            comparison.results[name] = solve(name, scene)
        else:
            comparison.reasons[name] = answer.reason
        if progress:
            progress((i + 1) / len(everything))
    comparison.rows = measure(comparison.results, spectral)
    return comparison


def measure(results: dict[str, xr.Dataset], spectral: bool = False) -> list[Row]:
    """Return the distances of every pair that is there, at every receiver."""
    rows = []
    for pair in PAIRS:
        if pair.one not in results or pair.other not in results:
            continue
        one, other = results[pair.one], results[pair.other]
        for quantity in ("stress", "velocity"):
            for i, y in enumerate(other[f"{quantity}_y"].values):
                a, b = one[quantity].values[i], other[quantity].values[i]
                dt = float(other.time[1] - other.time[0])
                found = distance(a.ravel(), b.ravel(), dt, spectral)
                rows.append(Row(pair, quantity, float(y), found))
    return rows
