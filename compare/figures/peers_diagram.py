"""The work-precision diagram of all codes: errors over the time of stepping and of the process."""

from math import nan
from types import SimpleNamespace
from typing import Any

from matplotlib.figure import Figure

from compare.experiments.study.diagram import draw as draw_study
from compare.experiments.study.pareto import assured
from compare.experiments.study.study import Curve, Study
from compare.solvers.continuum import EQUIVALENT_ROCK, JOINTED_ROCK
from compare.solvers.dem import DEM

COSTS = {"seconds": "seconds of stepping", "whole": "seconds of the whole process"}
OURS = {  # jointwave's curves have the colours of their engines
    "jointwave blocks": DEM.name,
    "jointwave blocks in space": DEM.name,
    "jointwave bar": EQUIVALENT_ROCK.name,
    "jointwave hexahedra": EQUIVALENT_ROCK.name,
    "jointwave hexahedra of order 2": EQUIVALENT_ROCK.name,
    "jointwave jointed bar": JOINTED_ROCK.name,
}


def draw(name: str, title: str, rows: list[dict[str, Any]]) -> Figure:
    """Return the diagram of the completed rows, each curve with its equations."""
    done = [row for row in rows if row["state"] == "done"]
    methods = {_label(row): OURS.get(row["curve"], row["curve"]) for row in done}
    curves = [Curve(label=label, method=method) for label, method in methods.items()]
    study = Study(title=title, scene="", timed=True, curves=curves)
    points: Any = [_point(row) for row in done]
    for point, error in zip(points, assured(points, "total"), strict=True):
        point.held = error
    return draw_study(name, study, points, COSTS)


def _label(row: dict[str, Any]) -> str:
    return f"{row['curve']}: {row['solves']}"


def _point(row: dict[str, Any]) -> SimpleNamespace:
    """Return a row of the table as a row of a study, for the diagram."""
    counted = ("freedoms", "steps", "seconds", "whole", "work")
    return SimpleNamespace(
        curve=_label(row),
        state="done",
        settings={},
        numerical=float(row.get("misfit", nan)),
        total=float(row.get("total_misfit", nan)),
        measured=nan,
        cancels=False,
        numerical_floor=0.0,
        total_floor=0.0,
        **{name: float(row.get(name, nan)) for name in counted},
    )
