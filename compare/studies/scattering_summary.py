"""Reflection and transmission at joints: the diagram, the table and the findings."""

from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from jointwave.compare.engines import Progress, solver
from jointwave.compare.exact.plane.waves import KINDS
from jointwave.compare.figures.export import blank, save
from jointwave.compare.figures.style import style
from jointwave.compare.runs.timings import machine
from jointwave.compare.studies.scattering import AT, COUNTS, TITLES, closed_form, run, scene_of
from jointwave.compare.studies.store import Pool
from jointwave.compare.studies.summary import Summary, write_tables
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


def make_study(
    name: str,
    out: Path,
    progress: Progress | None = None,
    brief: bool = False,
    pool: Pool | None = None,
) -> Summary:
    """Run a study of TITLES; write its table and figure into `out`, its points into OUT/NAME/.

    brief : only every other point, see `points`.
    """
    rows, title = pd.DataFrame(run(name, out / name, progress, brief, pool)), TITLES[name]
    done, failed = rows[rows.state == "done"], rows[rows.state == "failed"]
    data = rows.rename_axis("row").to_xarray().assign_attrs(title=title, **machine())
    figure = save(draw(name, done), out, name, title)
    files = [*write_tables(out, name, rows, data), *figure.drawings]
    said, varied = sentences(done), VARIED[name][0]
    shown = done.assign(residual=100 * done.residual).rename(
        columns={"residual": "residual, %", "freedoms": "DOFs", "cpu": "CPU, s"}
    )
    labels = [[_heading(*of) for of in zip(done.solver, done.incidence, strict=True)], done[varied]]
    reasons = failed.groupby(["solver", "message"], sort=False).size()
    return Summary(
        name,
        title,
        shown.set_index(pd.MultiIndex.from_arrays(labels, names=["", varied]))[
            [*WAVES, "error", "residual, %", "DOFs", "CPU, s"]
        ],
        said,
        [f"{one}, {count} runs: {why}" for (one, why), count in reasons.items()],
        files,
        {"rows": rows.to_dict("records"), "sentences": said, "files": list(map(str, files))},
        figure,
        NOTE,
        LEGEND,
        timed=True,
    )


def _heading(name: str, incidence: str) -> str:
    return f"{solver(name).words.label}: {incidence} wave"


def sentences(done: pd.DataFrame) -> list[str]:
    """Return the largest error of each solver and kind of wave, and the cost of all its runs."""
    found = []
    for of, some in done.groupby(["solver", "incidence"], sort=False):
        worst = some.loc[some.error.idxmax()]
        joints = "one joint" if worst.joints == 1 else f"{worst.joints} joints"
        found.append(
            f"{_heading(*of)}: error of at most {percent(worst.error)} % of the incident wave, at "
            f"{worst.angle:g} degrees and {joints}; {len(some)} runs take {some.cpu.sum():.2g} s "
            "of CPU time."
        )
    return found


def draw(name: str, done: pd.DataFrame) -> Figure:
    """Return the diagram of a study: moduli by angle or number, P and SV waves side by side.

    The closed form is a line, of wave w of kind k the SVG group NAME-exact-k-w; solver j is its
    points, NAME-k-j-w.
    """
    with blank(4.2) as figure:
        axes = figure.subplots(1, len(KINDS), squeeze=False, sharey=True)[0]
        for k, (ax, kind) in enumerate(zip(axes, KINDS, strict=True)):
            _draw_exact(ax, name, kind, k)
            of_kind = done[done.incidence == kind]
            for j, one in enumerate(done.solver.unique()):
                own = of_kind[of_kind.solver == one]
                look: dict[str, Any] = {"color": style(one).colour, "markersize": 8 - 2 * j}
                look |= {"markerfacecolor": "none"} if j else {}
                for w, (wave, (marker, _)) in enumerate(WAVES.items()):
                    label = None if w or k else f"{one}: points"
                    (line,) = ax.plot(own[VARIED[name][0]], own[wave], marker, label=label, **look)
                    line.set_gid(f"{name}-{k}-{j}-{w}")
            ax.set(ylim=(-0.03, 1.1), xlabel=VARIED[name][1], title=f"{kind} wave")
            ax.margins(x=0.03)  # so that no marker is cut
            ax.grid(color="#e4e7ea", linewidth=0.6)
        axes[0].set_ylabel("amplitude over the incident one")
        figure.legend(loc="outside upper center", ncols=4, frameon=False)
    return figure


def _draw_exact(ax: Axes, name: str, kind: str, k: int) -> None:
    if name == "oblique-joint":
        x: np.ndarray = np.arange(0, 88, 0.5)
        exact = np.array(closed_form(scene_of(kind, 0.0), np.radians(x)))
    else:
        x = np.arange(1, COUNTS[-1] + 1)
        exact = np.array([closed_form(scene_of(kind, AT, int(n))) for n in x]).T
        ax.set_xticks(x)
    for w, (wave, (marker, dashes)) in enumerate(WAVES.items()):
        (line,) = ax.plot(x, exact[w], color="#30363b", linewidth=1.0, linestyle=dashes)
        line.set_gid(f"{name}-exact-{k}-{w}")
        if k == 0:
            ax.plot([], [], color="#30363b", ls=dashes, marker=marker, label=f"|{wave}|")
