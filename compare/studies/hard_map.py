"""The stability map: step over critical step against damping ratio, one run for every cell.

If every dashpot is eta times its spring, the mode of highest frequency omega, with damping ratio
zeta = eta omega / 2, determines stability. The critical step of `numerics.critical_step`, over the
undamped one, is x = omega dt / 2 = sqrt(1 + 4 zeta^2) - 2 zeta. A cell is stable if its run ends.
"""

from math import pi
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure

from jointwave import cases
from jointwave.cases.errors import UnstableError
from jointwave.cases.scene_type import AnyScene
from jointwave.compare.engines import ENGINES, label_of, solve
from jointwave.compare.figures.export import blank
from jointwave.compare.figures.style import style
from jointwave.compare.scenes import find
from jointwave.compare.studies.store import Row

#: A short pillar with free ends under a stress step, which excites all modes.
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
LIGHT = "#eceff2"  # colour of unstable cells


def boundary(ratio: np.ndarray) -> np.ndarray:
    """Return the critical step over the undamped one for damping ratios of the highest mode."""
    return 1 / (np.sqrt(1 + 4 * ratio**2) + 2 * ratio)


def columns(engines: tuple[str, ...] = tuple(ENGINES), cells: int = CELLS) -> list[Row]:
    """Return the columns of some engines' maps, not yet computed: the `engine`, the damping `ratio`
    of the highest mode, and the `steps` at the cell centres, over the undamped critical step."""
    steps, ratios = np.geomspace(0.02, 2, cells).tolist(), np.geomspace(1e-3, 10, cells).tolist()
    return [{"engine": x, "ratio": zeta, "steps": steps} for x in engines for zeta in ratios]


def computed(column: Row) -> Row:
    """Run the cells of a column; return it with a list of which are `stable`."""
    engine, critical = ENGINES[column["engine"]], _prepared(column["engine"], {})
    beta = column["ratio"] * critical  # eta = 2 zeta / omega
    # Ratios proportional to frequencies give a zero Rayleigh alpha.
    rayleigh = {"frequencies": [1.0, 2.0], "ratios": [pi * beta, 2 * pi * beta]}
    damping = {"damping.rayleigh": rayleigh}

    def is_stable(dt: float) -> bool:
        fraction = dt / own * (1 + 1e-9)
        try:
            solve(engine.name, _scene(engine.engine, dt, fraction, damping))
        except UnstableError:
            return False
        return True

    with engine.bodies_kept():
        own = _prepared(column["engine"], damping)
        return column | {"stable": [is_stable(x * critical) for x in column["steps"]]}


def cells_to_run(column: Row) -> tuple[AnyScene, str, int]:
    """Return the scene with the undamped critical step, the engine, the number of stable cells."""
    engine, critical = ENGINES[column["engine"]], _prepared(column["engine"], {})
    stable = sum(x < boundary(np.array(column["ratio"])) for x in column["steps"])
    return _scene(engine.engine, critical, 1.0, {}), engine.name, int(stable)


def _prepared(engine: str, changes: dict[str, Any]) -> float:
    """Return the critical step of the loaded pillar with some changes, s."""
    return ENGINES[engine].prepare(cases.load_variant(find(SCENE), "", PUSHED | changes)).critical


def _scene(table: str, dt: float, fraction: float, changes: dict[str, Any]) -> AnyScene:
    """Return the loaded pillar with STEPS steps of dt, s, given also over the critical step."""
    interval = dt * STEPS / SAMPLES
    times = {"record.interval": interval, "time.duration": interval * SAMPLES}
    table = f"numerics.{table}"
    step = {f"{table}.step_fraction": fraction, f"{table}.allow_unstable": True}
    return cases.load_variant(find(SCENE), "", PUSHED | changes | times | step)


def cells_of(found: list[Row]) -> pd.DataFrame:
    """Return the cells of computed columns.

    wrong : whether a cell contradicts theory. far : wrong, and over one cell from the boundary.
    """
    cells = pd.DataFrame(found).explode(["steps", "stable"])
    cells = cells.rename(columns={"steps": "step"}).astype({"step": float, "stable": bool})
    limit, size = boundary(cells.ratio), found[0]["steps"][1] / found[0]["steps"][0]
    wrong = cells.stable != (cells.step < limit)
    beyond = np.abs(np.log(cells.step / limit)) > 1.5 * np.log(size)
    return cells.assign(wrong=wrong, far=wrong & beyond)


def draw_maps(cells: pd.DataFrame) -> Figure:
    """Return the maps of all engines with the theoretical limit; crosses mark wrong cells.

    The cells of engine k are the SVG group stability-map-k, its line stability-line-k.
    """
    with blank(3.6) as figure:
        axes = figure.subplots(1, cells.engine.nunique(), squeeze=False, sharey=True)[0]
        ratio = np.geomspace(cells.ratio.min(), cells.ratio.max(), 200)
        for k, (engine, own) in enumerate(cells.groupby("engine", sort=False)):
            ax, grid = axes[k], own.pivot(index="step", columns="ratio", values="stable")
            colours = ListedColormap([LIGHT, style(str(engine)).colour])
            mesh = ax.pcolormesh(grid.columns, grid.index, grid, shading="nearest", cmap=colours)
            mesh.set(gid=f"stability-map-{k}", clim=(0, 1))
            line = {"color": "#000000", "linewidth": 1.4, "gid": f"stability-line-{k}"}
            ax.plot(ratio, boundary(ratio), **line)
            wrong = own[own.wrong]
            ax.plot(wrong.ratio, wrong.step, "x", color="#d00000", markersize=5)
            ax.set(xscale="log", yscale="log", xlabel="damping ratio of the highest mode")
            words = f"{label_of(str(engine))}: {len(wrong)} cells on the wrong side"
            ax.set_title(f"({chr(97 + k)})  {words}")
            ax.text(0.06, 0.12, "stable", transform=ax.transAxes)
            ax.text(0.94, 0.9, "unstable", transform=ax.transAxes, ha="right")
        axes[0].set_ylabel("step over undamped critical step")
    return figure
