"""The stability map: step over critical step against damping ratio, one run for every cell.

With all dashpots eta times their springs the mode of the largest frequency omega decides. Its
damping ratio is zeta = eta omega / 2, and in x = omega dt / 2, the step over the undamped critical
one, the critical step of `numerics.critical_step` reads x = sqrt(1 + 4 zeta^2) - 2 zeta. A cell is
stable if the divergence monitor lets the run end.
"""

from math import pi
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap

from jointwave import cases
from jointwave.cases.errors import UnstableError
from jointwave.compare.engines import ENGINES, solve
from jointwave.compare.figures.style import style
from jointwave.compare.scenes import find
from jointwave.compare.solvers.record import Solver

#: A short pillar with free ends, pushed by a step, in which all modes move.
SCENE = "hard/short-pillar"
PUSHED: dict[str, Any] = {
    "pillar.length": 4.0,
    "numerics.continuum.elements_per_block": 1,
    "numerics.continuum.scheme": "explicit",
    "record.stress": [1.0],
    "record.velocity": [],
    "record.energy": False,
    "load": {"shape": "step", "amplitude": 1e6},
}
STEPS, SAMPLES = 3000, 10
CELLS = 24
LIGHT = "#eceff2"  # of unstable cells


class Column(NamedTuple):
    """The cells of one damping ratio: whether an engine is stable at each step over the critical
    one of the undamped pillar."""

    engine: str
    ratio: float
    steps: list[float]
    stable: list[bool]


class StabilityMap(NamedTuple):
    """The stability of an engine in every cell.

    ratio : float array [m], damping ratio of the highest mode; step : [n], over the undamped
    critical one; both at the centres of the cells, in equal ratios. stable : bool array [n, m].
    """

    engine: str
    ratio: np.ndarray
    step: np.ndarray
    stable: np.ndarray

    @property
    def wrong(self) -> np.ndarray:
        """Cells [n, m] that differ from theory at their centres."""
        return self.stable != (self.step[:, None] < boundary(self.ratio))

    @property
    def cells(self) -> pd.DataFrame:
        """The cells as a table."""
        ratio, step = np.meshgrid(self.ratio, self.step)
        columns = {"damping ratio": ratio, "step over undamped critical step": step}
        columns |= {"stable": self.stable, "wrong side": self.wrong}
        found = pd.DataFrame({name: values.T.ravel() for name, values in columns.items()})
        return found.assign(engine=self.engine)

    @property
    def far(self) -> np.ndarray:
        """Wrong cells further than one cell from the boundary."""
        grow = self.step[1] / self.step[0]
        below, above = (boundary(self.ratio) * f for f in (grow**-1.5, grow**1.5))
        near = (self.step[:, None] > below) & (self.step[:, None] < above)
        return self.wrong & ~near


def boundary(ratio: np.ndarray) -> np.ndarray:
    """Return the critical step over the undamped one at damping ratios of the highest mode."""
    return 1 / (np.sqrt(1 + 4 * ratio**2) + 2 * ratio)


def columns(engines: tuple[str, ...] = tuple(ENGINES), cells: int = CELLS) -> list[Column]:
    """Return the columns of the maps of some engines, not yet computed."""
    steps = np.geomspace(0.02, 2, cells).tolist()
    return [
        Column(engine, float(zeta), steps, [])
        for engine in engines
        for zeta in np.geomspace(1e-3, 10, cells)
    ]


def computed(column: Column) -> Column:
    """Return a column with its cells."""
    engine = ENGINES[column.engine]
    critical = engine.prepare(cases.load_variant(find(SCENE), "", PUSHED)).critical
    beta = column.ratio * critical  # eta = 2 zeta / omega
    # Ratios in proportion to frequencies leave Rayleigh's alpha zero.
    damped = {"damping.rayleigh": {"frequencies": [1.0, 2.0], "ratios": [pi * beta, 2 * pi * beta]}}
    own = engine.prepare(cases.load_variant(find(SCENE), "", PUSHED | damped)).critical
    stable = [_is_stable(engine, damped, x * critical, own) for x in column.steps]
    return column._replace(stable=stable)


def _is_stable(engine: Solver, damped: dict[str, Any], dt: float, critical: float) -> bool:
    """Return whether a run by steps of dt (s) ends, at this critical step (s) of the scene."""
    interval = dt * STEPS / SAMPLES
    numerics = {"step_fraction": dt / critical * (1 + 1e-9), "allow_unstable": True}
    changes = PUSHED | damped | {f"numerics.{engine.engine}.{k}": v for k, v in numerics.items()}
    changes |= {"record.interval": interval, "time.duration": interval * SAMPLES}
    try:
        solve(engine.name, cases.load_variant(find(SCENE), "", changes))
    except UnstableError:
        return False
    return True


def maps_of(found: list[Column]) -> list[StabilityMap]:
    """Return the maps that columns make, by engine."""
    maps = []
    for engine in dict.fromkeys(one.engine for one in found):
        own = [one for one in found if one.engine == engine]
        ratio, step = np.array([one.ratio for one in own]), np.array(own[0].steps)
        maps.append(StabilityMap(engine, ratio, step, np.array([one.stable for one in own]).T))
    return maps


def draw_map(ax: Axes, one: StabilityMap, k: int) -> None:
    """Draw a map under the theoretical line; crosses mark cells on its wrong side. Its cells are
    the SVG group stability-map-k, the line stability-line-k."""
    colours = [LIGHT, style(one.engine).colour]
    mesh = ax.pcolormesh(
        one.ratio, one.step, one.stable, shading="nearest", cmap=ListedColormap(colours)
    )
    mesh.set(gid=f"stability-map-{k}", clim=(0, 1))
    ratio = np.geomspace(one.ratio[0], one.ratio[-1], 200)
    (line,) = ax.plot(ratio, boundary(ratio), color="#000000", linewidth=1.4)
    line.set_gid(f"stability-line-{k}")
    i, j = np.nonzero(one.wrong)
    ax.plot(one.ratio[j], one.step[i], "x", color="#d00000", markersize=5)
    ax.set(xscale="log", yscale="log", xlabel="damping ratio of the highest mode")
    ax.set_title(f"({chr(97 + k)})  {one.engine}: {len(i)} cells on the wrong side")
    ax.text(0.06, 0.12, "stable", transform=ax.transAxes)
    ax.text(0.94, 0.9, "unstable", transform=ax.transAxes, ha="right")
