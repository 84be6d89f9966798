"""Reflection and transmission of P and SV waves at joints, by every solver of rock masses.

`transmission` sets the scenes and computes the amplitudes. Columns of the table: `solver`,
`incidence` ("P" or "SV"), `angle` from the joints' normal (degrees), number of `joints`; R_p to
T_s, moduli of particle velocity over the incident one at the pulse's frequency; `error`, largest
difference from the closed form; `residual`, part of the motion that plane waves do not explain;
`freedoms` of the blocks or the rock; `cpu`, CPU time with set-up, without compiling (s).
"""

from collections.abc import Sequence
from functools import partial
from math import nan
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from jointwave.cases.read import load
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.compare.engines import solve, solver
from jointwave.compare.exact.plane.oblique_joint import Joint
from jointwave.compare.exact.plane.waves import KINDS, Kind
from jointwave.compare.figures.export import blank, save
from jointwave.compare.figures.style import style
from jointwave.compare.runs.output import write_csv, write_dataset
from jointwave.compare.runs.timings import machine
from jointwave.compare.solvers.continuum import JOINTED_ROCK
from jointwave.compare.solvers.dem import DEM
from jointwave.compare.studies import store
from jointwave.compare.studies import transmission as waves
from jointwave.compare.studies.experiment import Experiment, Summary
from jointwave.compare.studies.forecast import Run
from jointwave.compare.studies.store import Row
from jointwave.compare.studies.transmission import SCENE, ParallelJoints
from jointwave.compare.text import percent

ANGLES = (0.0, 15.0, 30.0, 45.0, 60.0, 75.0)  # degrees from the joints' normal
COUNTS, AT = (2, 3, 5), 30.0  # numbers of parallel joints, and their angle, degrees
SPACING = 0.960768922830523  # m, a tenth of the P wavelength
COMPILED = 0.05  # s of compiling, above which a run is repeated for timing
#: The studies; each is named like its exact solution.
TITLES = {
    "oblique-joint": "Reflection and transmission at one joint against the angle",
    "parallel-joints": "Reflection and transmission of parallel joints at 30 degrees",
}

WAVES = {"R_p": ("o", "-"), "R_s": ("s", "--"), "T_p": ("^", "-."), "T_s": ("v", ":")}
#: The varied column of each study, with its heading.
VARIED = {
    "oblique-joint": ("angle", "angle from the joint's normal, degrees"),
    "parallel-joints": ("joints", "number of joints"),
}
NOTE = (
    "Moduli of particle velocity over the incident one, at the peak frequency of the pulse, where "
    "K_n = Z_p omega and K_s = Z_s omega; P and S waves are 9.6 m and 5.5 m long, and several "
    "joints a tenth of the former apart. The exact field of the joints enters through all sides."
)
LEGEND = (
    "Error: the largest difference from the closed form. Residual: motion that plane waves "
    "of the rock cannot represent. CPU: time of a run, with set-up, without compiling."
)
INK = "#30363b"


def points(study: str, brief: bool = False) -> list[Row]:
    """Return the points of a study by solver: one joint at all angles, or several joints at one.

    brief : only every other angle or number of joints.
    """
    one = study == "oblique-joint"
    places = [(x, 1) for x in ANGLES] if one else [(AT, count) for count in COUNTS]
    names = ("solver", "incidence", "angle", "joints")
    return [
        dict(zip(names, (name, kind, *place), strict=True))
        for name in (study, JOINTED_ROCK.name, DEM.name)
        for kind in KINDS
        for place in places[:: 2 if brief else 1]
    ]


def joints_of(count: int) -> ParallelJoints:
    """Return `count` copies of the joint of `joints.toml`, a tenth of the P wavelength apart."""
    base: Any = load(SCENE)[0]
    (one,), period = base.joint_sets, base.waves[0].period
    joint = Joint(one.normal_stiffness, one.shear_stiffness)
    return ParallelJoints(base.rock, [joint] * count, np.full(count - 1, SPACING), period)


def scene_at(point: Row) -> RockMass:
    """Return the scene of a point."""
    return waves.scene_of(joints_of(point["joints"]), point["incidence"], point["angle"])


def measure(point: Row) -> Row:
    """Run a point and return its row; raises the errors of `solve`."""
    scene = scene_at(point)
    for _ in range(2):
        began = process_time()
        result = solve(point["solver"], scene)
        cpu = process_time() - began
        if float(result.attrs.get("seconds_compile", 0.0)) <= COMPILED:
            break
    *found, residual = waves.amplitudes(scene, result.velocity.values)
    exact = waves.closed_form(joints_of(point["joints"]), point["incidence"], point["angle"])
    error = float(np.abs(found - exact).max())
    freedoms = float(result.attrs.get("degrees_of_freedom", nan))
    numbers = {"error": error, "residual": residual, "freedoms": freedoms, "cpu": cpu}
    return point | dict(zip(WAVES, found, strict=True)) | numbers


def experiment(name: str, out: Path, brief: bool = False) -> Experiment:
    """Return a study of TITLES, with its table and figure in `out`, its points in OUT/NAME/.

    Seconds are CPU time, so several points may run at a time. brief : see `points`.
    """

    def key(point: Row) -> str:
        return store.key(point, load(SCENE)[0].model_dump_json())

    def runs(left: Sequence[Row]) -> list[Run]:
        return [Run(name, scene_at(one), one["solver"]) for one in left]

    wanted, summary = points(name, brief), partial(summarise, name, out)
    return Experiment(TITLES[name], wanted, out / name, key, measure, summary, runs, timed=True)


def summarise(name: str, out: Path, found: list[Row]) -> Summary:
    """Return the summary of a study; write its table and its figure into `out`."""
    rows, title = pd.DataFrame(found), TITLES[name]
    data = rows.rename_axis("row").to_xarray().assign_attrs(title=title, **machine())
    figure = save(draw(name, rows), out, name, title)
    files = [write_csv(out / f"{name}.csv", rows), write_dataset(out / f"{name}.nc", data)]
    numbers = [*files, *figure.drawings], {"rows": rows.to_dict("records")}, figure
    shown = table(name, rows), sentences(rows), (), *numbers
    return Summary(name, title, *shown, NOTE, LEGEND, timed=True)


def table(name: str, rows: pd.DataFrame) -> pd.DataFrame:
    """Return the moduli and their error under headings of solver and wave."""
    varied = VARIED[name][0]
    found = rows.assign(**{"": _headings(rows), "residual, %": 100 * rows.residual})
    found = found.rename(columns={"freedoms": "DOFs", "cpu": "CPU, s"}).set_index(["", varied])
    return found[[*WAVES, "error", "residual, %", "DOFs", "CPU, s"]]


def _headings(rows: pd.DataFrame) -> pd.Series:
    return rows.solver.map(lambda x: solver(x).label) + ": " + rows.incidence + " wave"


def sentences(rows: pd.DataFrame) -> list[str]:
    """Return the largest error and the total cost of each solver and kind of wave."""
    found = []
    for heading, some in rows.groupby(_headings(rows), sort=False):
        worst = some.loc[some.error.idxmax()]
        joints = "one joint" if worst.joints == 1 else f"{worst.joints} joints"
        found.append(
            f"{heading}: error of at most {percent(worst.error)} % of the incident wave, at "
            f"{worst.angle:g} degrees and {joints}; {len(some)} runs take {some.cpu.sum():.2g} s "
            "of CPU time."
        )
    return found


def draw(name: str, rows: pd.DataFrame) -> Figure:
    """Return the diagram of a study: moduli over angle or number, P and SV waves side by side.

    SVG groups of incident kind k, wave w: the closed form NAME-exact-k-w, solver j NAME-k-j-w.
    """
    varied, heading = VARIED[name]
    with blank(3.6) as figure:
        axes = figure.subplots(1, len(KINDS), squeeze=False, sharey=True)[0]
        for k, (ax, kind) in enumerate(zip(axes, KINDS, strict=True)):
            x, exact = _exact(name, kind)
            for w, (wave, (marker, dashes)) in enumerate(WAVES.items()):
                ax.plot(x, exact[w], color=INK, lw=1.0, ls=dashes, gid=f"{name}-exact-{k}-{w}")
                for j, one in enumerate(rows.solver.unique()):
                    own = rows[(rows.incidence == kind) & (rows.solver == one)]
                    look: dict[str, Any] = {"color": style(one).colour, "markersize": 8 - 2 * j}
                    look |= {"markerfacecolor": "none"} if j else {}
                    look["label"] = None if w else f"{solver(one).label}: points"
                    ax.plot(own[varied], own[wave], marker, gid=f"{name}-{k}-{j}-{w}", **look)
            ax.set(ylim=(-0.03, 1.1), xlabel=heading, title=f"{kind} wave")
            ax.margins(x=0.03)  # so that no marker is cut
            ax.grid(color="#e4e7ea", linewidth=0.6)
        for wave, (marker, dashes) in WAVES.items():
            axes[0].plot([], [], color=INK, ls=dashes, marker=marker, label=f"|{wave}|")
        axes[0].set_ylabel("amplitude over the incident one")
        handles = axes[0].get_legend_handles_labels()
        figure.legend(*handles, loc="outside upper center", ncols=4, frameon=False)
    return figure


def _exact(name: str, kind: Kind) -> tuple[np.ndarray, np.ndarray]:
    """Return the varied values and the moduli [4, values] in closed form."""
    if name == "oblique-joint":
        x: np.ndarray = np.arange(0, 88, 0.5)
        return x, waves.closed_form(joints_of(1), kind, x)
    x = np.arange(1, COUNTS[-1] + 1)
    return x, np.array([waves.closed_form(joints_of(int(n)), kind, AT) for n in x]).T
