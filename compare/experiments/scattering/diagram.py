"""Diagram of reflection and transmission at joints against the angle or their number.

A row for each kind of wave, with the cost of the runs beside it.

The closed form is a line; a solver is its points, in its own colour, a marker for each of the four
waves.
"""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, MaxNLocator, NullFormatter

from compare.exact.plane.waves import KINDS
from compare.experiments.scattering.points import AT, COUNTS, JointsRow, closed_form, scene_of
from compare.figures.blank import blank
from compare.figures.style import style

WAVES = {"R_p": ("o", "-"), "R_s": ("s", "--"), "T_p": ("^", "-."), "T_s": ("v", ":")}
LINE = "#30363b"  # of the closed form
AXES = {
    "oblique-joint": "angle from the joint's normal, degrees",
    "parallel-joints": "number of joints",
}
WORDS = {"P": "P wave", "SV": "SV wave"}


def draw(name: str, rows: list[JointsRow]) -> Figure:
    """Return the diagram of a study; the closed form of wave w of row k is the SVG group
    NAME-exact-k-w, the points of solver j NAME-k-j-w."""
    done = [row for row in rows if row.state == "done"]
    solvers = list(dict.fromkeys(row.solver for row in done))
    with blank(3.3 * len(KINDS) + 0.5) as figure:
        axes = figure.subplots(len(KINDS), 2, width_ratios=(3, 1.3), squeeze=False, sharex="col")
        for k, kind in enumerate(KINDS):
            of_kind = [row for row in done if row.incidence == kind]
            _draw_moduli(axes[k, 0], of_kind, solvers, kind, f"{name}-{k}")
            _draw_cost(axes[k, 1], of_kind, solvers)
        found = zip(*axes[0, 0].get_legend_handles_labels()[::-1], strict=True)
        entries = dict(sorted(found, key=lambda entry: not entry[0].startswith("|")))
        figure.legend(entries.values(), entries, loc="outside upper center", ncols=4, frameon=False)
        axes[-1, 0].set_xlabel(AXES[name])
        axes[-1, 1].set_xlabel("CPU seconds of a run")
    return figure


def _draw_moduli(ax: Axes, rows: list[JointsRow], solvers: list[str], kind: str, gid: str) -> None:
    name, _, k = gid.rpartition("-")
    by_angle = name == "oblique-joint"
    x, exact = _of_angles(kind) if by_angle else _of_counts(kind)
    for w, (wave, (marker, dashes)) in enumerate(WAVES.items()):
        (line,) = ax.plot(x, exact[w], color=LINE, linewidth=1.0, linestyle=dashes)
        line.set_gid(f"{name}-exact-{k}-{w}")
        ax.plot([], [], color=LINE, linestyle=dashes, marker=marker, label=f"|{wave}|")
        for j, solver in enumerate(solvers):
            own = [row for row in rows if row.solver == solver]
            (points,) = ax.plot(
                [row.angle if by_angle else row.joints for row in own],
                [getattr(row, wave) for row in own],
                marker,
                color=style(solver).colour,
                markersize=8 - 2 * j,
                markerfacecolor="none" if j else None,
                label=f"{solver}: points" if w == 0 else None,
            )
            points.set_gid(f"{gid}-{j}-{w}")
    ax.set(ylim=(-0.03, 1.1), ylabel="amplitude over the incident one")
    ax.set_title(WORDS[kind])
    if not by_angle:
        ax.xaxis.set_major_locator(MaxNLocator(integer=True))
    ax.grid(color="#e4e7ea", linewidth=0.6)


def _of_angles(kind: str) -> tuple[np.ndarray, np.ndarray]:
    """Return angles, degrees, and the closed form at them [wave, angles]."""
    angles = np.arange(0, 88, 0.5)
    return angles, np.array(closed_form(scene_of(kind, 0.0), np.radians(angles)))


def _of_counts(kind: str) -> tuple[np.ndarray, np.ndarray]:
    """Return numbers of joints and the closed form of them [wave, numbers]."""
    counts = np.arange(1, COUNTS[-1] + 1)
    return counts, np.array([closed_form(scene_of(kind, AT, int(n))) for n in counts]).T


def _draw_cost(ax: Axes, rows: list[JointsRow], solvers: list[str]) -> None:
    for j, solver in enumerate(solvers):
        own = [row for row in rows if row.solver == solver and row.error > 0]
        ax.loglog(
            [max(row.cpu, 1e-3) for row in own],
            [row.error for row in own],
            "o",
            color=style(solver).colour,
            markersize=8 - 2 * j,
            markerfacecolor="none" if j else None,
        )
    ax.xaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    ax.xaxis.set_major_formatter("{x:g}")
    ax.xaxis.set_minor_formatter(NullFormatter())
    ax.set_ylabel("off from the closed form")
    ax.grid(color="#e4e7ea", linewidth=0.6)
