"""A figure for a paper: the waveforms of a scene."""

from pathlib import Path
from typing import Any

from jointwave.cases.errors import SceneError
from jointwave.cases.scene_type import AnyScene
from jointwave.compare.engines import Progress, applies
from jointwave.compare.misfit.alignment import align_curve
from jointwave.compare.misfit.pairs import Comparison
from jointwave.compare.misfit.ranking import applicable
from jointwave.compare.runs.comparison import solved
from jointwave.compare.runs.jobs import names_of
from jointwave.compare.runs.output import refuse_foreign
from jointwave.compare.runs.reuse import NOWHERE, ResultFolder

#: First bytes of a file of each kind: only such a file is overwritten.
BEGINS = {".pdf": (b"%PDF",), ".svg": (b"<?xml", b"<svg"), ".png": (b"\x89PNG",)}


def check_file(path: Path) -> None:
    """Raise SceneError if a figure cannot be written there: for its suffix, or for a file of
    another kind."""
    if path.suffix not in BEGINS:
        raise SceneError("--out", str(path), None, f"must end in {', '.join(BEGINS)}")
    refuse_foreign(path, BEGINS[path.suffix])


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
