"""A figure for a paper: the waveforms of a scene."""

from typing import Any

from jointwave.cases.scene_type import AnyScene
from jointwave.compare.engines import Progress, applies
from jointwave.compare.misfit.alignment import align_curve
from jointwave.compare.misfit.pairs import Comparison
from jointwave.compare.misfit.ranking import applicable
from jointwave.compare.runs.comparison import solved
from jointwave.compare.runs.jobs import names_of
from jointwave.compare.runs.reuse import NOWHERE, ResultFolder


def solve(
    scene: AnyScene,
    runs: list[tuple[str, str | None]],
    curves: list[Any],
    progress: Progress,
    stored: ResultFolder = NOWHERE,
) -> Comparison:
    """Return a scene's solutions and external curves.

    runs : (engine, model) each, see `compare.runs.jobs`; empty: all that apply.
    """
    asked = {name: applies(name, scene) for run in runs for name in names_of(*run, scene)}
    found = solved(scene, asked or applicable(scene), progress, stored)
    found.besides += [align_curve(curve, scene, found.results, False) for curve in curves]
    return found
