"""The work-precision diagram of all codes: their errors over stepping and over whole processes."""

from math import nan
from typing import Any, NamedTuple

from matplotlib.figure import Figure

from compare.experiments.study.diagram import draw as draw_study
from compare.experiments.study.pareto import assured
from compare.experiments.study.study import Curve, Study

COSTS = {"seconds": "seconds of stepping", "whole": "seconds of the whole process"}
OURS = {  # how our curves are coloured: as their engines are everywhere
    "jointwave blocks": "dem",
    "jointwave blocks in space": "dem",
    "jointwave bar": "continuum-equivalent",
    "jointwave hexahedra": "continuum-equivalent",
    "jointwave hexahedra of order 2": "continuum-equivalent",
    "jointwave jointed bar": "continuum-jointed",
}


class Point(NamedTuple):
    """What the diagram shows of a row of the table; in words of a study's row."""

    curve: str
    state: str
    settings: dict[str, Any]
    numerical: float
    total: float
    freedoms: float
    steps: float
    seconds: float
    whole: float
    work: float
    measured: float = nan
    held: float = nan
    cancels: bool = False
    numerical_floor: float = 0.0
    total_floor: float = 0.0


def draw(name: str, title: str, rows: list[dict[str, Any]]) -> Figure:
    """Return the diagram of the rows that were done, each curve with what it solves."""
    done = [row for row in rows if row["state"] == "done"]
    solves = {row["curve"]: row["solves"] for row in done}
    curves = [
        Curve(label=_label(curve, text), method=OURS.get(curve, curve))
        for curve, text in solves.items()
    ]
    study = Study(title=title, scene="", timed=True, curves=curves)
    points: Any = [_point(row) for row in done]
    held = assured(points, "total")
    points = [point._replace(held=error) for point, error in zip(points, held, strict=True)]
    return draw_study(name, study, points, COSTS)


def _label(curve: str, solves: str) -> str:
    return f"{curve}: {solves}"


def _point(row: dict[str, Any]) -> Point:
    def number(column: str) -> float:
        return float(row.get(column, nan))

    return Point(
        curve=_label(row["curve"], row["solves"]),
        state="done",
        settings={},
        numerical=number("misfit"),
        total=number("total_misfit"),
        freedoms=number("freedoms"),
        steps=number("steps"),
        seconds=number("seconds"),
        whole=number("whole"),
        work=number("work"),
    )
