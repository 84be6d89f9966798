"""Reflection and transmission against the angle: a row a kind of wave, beside it what runs cost.

The closed form is a line; a solver is its points, in its own colour, a marker for each of the four
waves.
"""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from compare.exact.plane.waves import KINDS
from compare.experiments.scattering.angles import AngleRow, closed_form, scene_of
from compare.figures.blank import blank
from compare.figures.style import style

WAVES = {"R_p": ("o", "-"), "R_s": ("s", "--"), "T_p": ("^", "-."), "T_s": ("v", ":")}
LINE = "#30363b"  # of the closed form
WORDS = {"P": "P wave", "SV": "SV wave"}


def draw(rows: list[AngleRow]) -> Figure:
    """Return the diagram; the closed form of wave w of row k is the SVG group
    oblique-joint-exact-k-w, the points of solver j oblique-joint-k-j-w."""
    done = [row for row in rows if row.state == "done"]
    solvers = list(dict.fromkeys(row.solver for row in done))
    with blank(3.3 * len(KINDS) + 0.5) as figure:
        axes = figure.subplots(len(KINDS), 2, width_ratios=(3, 1.3), squeeze=False, sharex="col")
        for k, kind in enumerate(KINDS):
            of_kind = [row for row in done if row.incidence == kind]
            _draw_moduli(axes[k, 0], of_kind, solvers, kind, k)
            _draw_cost(axes[k, 1], of_kind, solvers)
        entries = dict(zip(*axes[0, 0].get_legend_handles_labels()[::-1], strict=True))
        figure.legend(entries.values(), entries, loc="outside upper center", ncols=4, frameon=False)
        axes[-1, 0].set_xlabel("angle from the joint's normal, degrees")
        axes[-1, 1].set_xlabel("CPU seconds of a run")
    return figure


def _draw_moduli(ax: Axes, rows: list[AngleRow], solvers: list[str], kind: str, k: int) -> None:
    angles = np.arange(0, 88, 0.5)
    exact = np.array(closed_form(scene_of(kind, 0.0), np.radians(angles)))
    for w, (name, (marker, dashes)) in enumerate(WAVES.items()):
        (line,) = ax.plot(angles, exact[w], color=LINE, linewidth=1.0, linestyle=dashes)
        line.set_gid(f"oblique-joint-exact-{k}-{w}")
        ax.plot([], [], color=LINE, linestyle=dashes, marker=marker, label=f"|{name}|")
        for j, solver in enumerate(solvers):
            own = [row for row in rows if row.solver == solver]
            (points,) = ax.plot(
                [row.angle for row in own],
                [getattr(row, name) for row in own],
                marker,
                color=style(solver).colour,
                markersize=8 - 2 * j,
                markerfacecolor="none" if j else None,
                label=f"{solver}: points" if w == 0 else None,
            )
            points.set_gid(f"oblique-joint-{k}-{j}-{w}")
    ax.set(xlim=(-2, 90), ylim=(-0.03, 1.1), ylabel="amplitude over the incident one")
    ax.set_title(WORDS[kind])
    ax.grid(color="#e4e7ea", linewidth=0.6)


def _draw_cost(ax: Axes, rows: list[AngleRow], solvers: list[str]) -> None:
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
    ax.set_ylabel("off from the closed form")
    ax.grid(color="#e4e7ea", linewidth=0.6)
