"""Influence over cost of every effect, both axes logarithmic: one point per effect of a scene."""

from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import LogLocator, NullFormatter

from compare.experiments.ablation.ablation import Ablation, EffectCost
from compare.figures.export import blank

LEAST_SHARE = 0.5  # %, of a step: less is within the noise of timings
LEAST_MISFIT = 0.01  # %: smaller and zero misfits are drawn here
NEAR = 24.0, 13.0  # pixels: closer numbers of one effect would overlap

MARKERS = "osD^vP*X<>hpd8H"
#: Safe for all kinds of colour blindness, by marker and colour in turn (Okabe & Ito 2008).
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#8a6d00", "#56b4e9", "#000000")

Place = tuple[float, float]


def draw(found: list[Ablation]) -> Figure:
    """Return the diagram; points are labelled by the number of their scene in the table.

    Points at an edge lie there or beyond, and are hollow. The points of the k-th effect are the SVG
    group effects-points-k.
    """
    by_effect: dict[str, list[tuple[int, EffectCost]]] = {}
    for number, b in enumerate(found, start=1):
        for w in b.effects:
            if not w.reason:
                by_effect.setdefault(w.effect, []).append((number, w))
    with blank(max(4.6, 0.6 + 0.17 * (len(found) + len(by_effect)))) as figure:
        ax = figure.subplots()
        drawn = [_draw_effect(ax, k, *one) for k, one in enumerate(by_effect.items())]
        _finish(ax)
        _add_legend(figure, ax, found)
        figure.set_layout_engine("constrained")
        figure.canvas.draw()
        for numbered in drawn:
            _number(ax, numbered)
    return figure


def _draw_effect(
    ax: Axes, k: int, effect: str, ones: list[tuple[int, EffectCost]]
) -> list[tuple[int, Place]]:
    """Draw the points of an effect; return the number and position of each."""
    marks: dict[str, Any] = {
        "color": COLOURS[k % len(COLOURS)],
        "marker": MARKERS[k % len(MARKERS)],
        "linestyle": "none",
        "markersize": 7,
    }
    places = [(max(100 * w.share, LEAST_SHARE), max(100 * w.misfit, LEAST_MISFIT)) for _, w in ones]
    (line,) = ax.plot(*zip(*places, strict=True), **marks, markerfacecolor="none", label=effect)
    line.set_gid(f"effects-points-{k}")
    inside = [p for p in places if p[0] > LEAST_SHARE and p[1] > LEAST_MISFIT]
    if inside:
        ax.plot(*zip(*inside, strict=True), **marks)
    return [(number, place) for (number, _), place in zip(ones, places, strict=True)]


def _finish(ax: Axes) -> None:
    ax.set_xscale("log")
    ax.set_yscale("log")
    ax.set_xlim(LEAST_SHARE / 1.12, 150)
    ax.set_ylim(LEAST_MISFIT / 1.8, max(300, 1.5 * ax.get_ylim()[1]))
    ax.set_xlabel("cost: share of a block's step in the scene, %")
    ax.set_ylabel("influence: misfit of the result without the effect, %")
    for axis, least in ((ax.xaxis, LEAST_SHARE), (ax.yaxis, LEAST_MISFIT)):
        ticks = [10.0**n for n in range(-3, 7) if 10.0**n > 1.1 * least]
        low, high = axis.get_view_interval()
        ticks = [least, *(t for t in ticks if low < t < high)]
        axis.set_ticks(ticks, [f"≤ {least:g}", *(f"{t:g}" for t in ticks[1:])])
        axis.set_minor_locator(LogLocator(subs="all"))
        axis.set_minor_formatter(NullFormatter())
    ax.grid(which="major", color="#e4e7ea", linewidth=0.6)


def _add_legend(figure: Figure, ax: Axes, found: list[Ablation]) -> None:
    handles, labels = ax.get_legend_handles_labels()
    nothing = Line2D([], [], linestyle="none")
    names = [f"{number}  {b.label}" for number, b in enumerate(found, start=1)]
    figure.legend(
        [*handles, *[nothing] * (1 + len(names))],
        [*labels, "", *names],
        loc="outside right upper",
        fontsize=8,
        labelspacing=0.35,
        frameon=False,
    )


def _number(ax: Axes, numbered: list[tuple[int, Place]]) -> None:
    """Write the numbers of an effect's points beside them, close ones together."""
    spots: list[tuple[Place, list[int]]] = []
    placed = [(ax.transData.transform(place), number) for number, place in numbered]
    for (x, y), number in sorted((tuple(at), number) for at, number in placed):
        for i, ((left, low), numbers) in enumerate(spots):
            if x - left < NEAR[0] and abs(y - low) < NEAR[1]:
                spots[i] = (x, low), [*numbers, number]
                break
        else:
            spots.append(((x, y), [number]))
    for spot, numbers in spots:
        ax.annotate(
            ", ".join(map(str, sorted(numbers))),
            tuple(ax.transData.inverted().transform(spot)),
            xytext=(6, 3),
            textcoords="offset points",
            fontsize=8,
        )
