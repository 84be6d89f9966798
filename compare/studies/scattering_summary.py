"""Reflection and transmission at joints: the diagram, the table and the findings."""

from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from jointwave.compare.engines import Progress, solver
from jointwave.compare.exact.plane.waves import KINDS, Kind
from jointwave.compare.figures.export import blank, save
from jointwave.compare.figures.style import style
from jointwave.compare.runs.output import write_csv, write_dataset
from jointwave.compare.runs.timings import machine
from jointwave.compare.studies import scattering
from jointwave.compare.studies.joint_waves import closed_form
from jointwave.compare.studies.scattering import AT, COUNTS, TITLES, JointsRow, joints_of
from jointwave.compare.studies.store import Pool, Store, alone
from jointwave.compare.studies.summary import Summary
from jointwave.compare.text import percent

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


def make_study(
    name: str,
    out: Path,
    brief: bool = False,
    pool: Pool | None = None,
    progress: Progress | None = None,
) -> Summary:
    """Run a study of TITLES; write its table and figure into `out`, its points into OUT/NAME/.

    Seconds are CPU time: as many points may run at a time as there are cores. brief : only every
    other point, see `points`.
    """
    saved: Store[JointsRow] = Store(JointsRow, out / name)
    wanted = scattering.points(name, brief)
    with alone():
        found = saved.compute(wanted, scattering.key, scattering.measure, pool, progress)
    rows, title = pd.DataFrame(found), TITLES[name]
    data = rows.rename_axis("row").to_xarray().assign_attrs(title=title, **machine())
    figure = save(draw(name, rows), out, name, title)
    files = [write_csv(out / f"{name}.csv", rows), write_dataset(out / f"{name}.nc", data)]
    numbers = [*files, *figure.drawings], {"rows": rows.to_dict("records")}, figure
    shown = table(name, rows), sentences(rows), (), *numbers
    return Summary(name, title, *shown, NOTE, LEGEND, timed=True)


def table(name: str, rows: pd.DataFrame) -> pd.DataFrame:
    """Return the moduli and their error under headings of their solver and wave."""
    varied = VARIED[name][0]
    found = rows.assign(**{"": _headings(rows), "residual, %": 100 * rows.residual})
    found = found.rename(columns={"freedoms": "DOFs", "cpu": "CPU, s"}).set_index(["", varied])
    return found[[*WAVES, "error", "residual, %", "DOFs", "CPU, s"]]


def _headings(rows: pd.DataFrame) -> pd.Series:
    return rows.solver.map(lambda x: solver(x).label) + ": " + rows.incidence + " wave"


def sentences(rows: pd.DataFrame) -> list[str]:
    """Return the largest error of each solver and kind of wave, and the cost of all its runs."""
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
    """Return the diagram of a study: moduli by angle or number, P and SV waves side by side.

    The closed form is a line, of wave w of kind k the SVG group NAME-exact-k-w; solver j is its
    points, NAME-k-j-w.
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
        return x, closed_form(joints_of(1), kind, x)
    x = np.arange(1, COUNTS[-1] + 1)
    return x, np.array([closed_form(joints_of(int(n)), kind, AT) for n in x]).T
