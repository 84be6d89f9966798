"""The file of a figure for a paper, of a scene or of an ensemble."""

from functools import partial
from importlib.metadata import version
from pathlib import Path
from typing import Any, NamedTuple

import matplotlib
from matplotlib.figure import Figure

from jointwave.cases.errors import SceneError
from jointwave.cases.scene_type import AnyScene
from jointwave.compare.engines import EXACT, Progress, applies
from jointwave.compare.figures import bands
from jointwave.compare.figures.export import write_drawing
from jointwave.compare.figures.publication import MM, STYLES, draw
from jointwave.compare.misfit.alignment import align_curve
from jointwave.compare.misfit.ranking import applicable
from jointwave.compare.runs.comparison import solved
from jointwave.compare.runs.jobs import names_of
from jointwave.compare.runs.output import refuse_foreign

#: First bytes of a file of each kind: only such a file is overwritten.
BEGINS = {"pdf": (b"%PDF",), "svg": (b"<?xml", b"<svg"), "png": (b"\x89PNG",)}


class FigureRequest(NamedTuple):
    """The request of `jointwave figure`; kind : None to follow the file's suffix."""

    style: str
    columns: int
    kind: str | None
    language: str
    out: Path

    @property
    def format(self) -> str:
        """pdf, svg or png; raises SceneError for others, or if the suffix contradicts it."""
        named = self.out.suffix.removeprefix(".").lower()
        allowed = BEGINS if self.kind is None else [self.kind]
        if named not in allowed:
            raise SceneError("--out", str(self.out), None, f"must end in .{', .'.join(allowed)}")
        return named


def make(
    scenes: list[AnyScene],
    runs: list[tuple[str, str | None]],
    curves: list[Any],
    request: FigureRequest,
    progress: Progress,
) -> Path:
    """Solve scenes, draw them with external curves, and write the figure.

    runs : (engine, model) each, see `compare.runs.jobs`; empty: all that apply.
    """
    kind, appearance = request.format, STYLES[request.style]
    asked = [
        {name: applies(name, scene) for run in runs for name in names_of(*run, scene)}
        or applicable(scene)
        for scene in scenes
    ]
    found = []
    for i, (scene, answers) in enumerate(zip(scenes, asked, strict=True)):
        one = solved(scene, answers, partial(_tell, progress, i, len(scenes)))
        one.besides += [align_curve(curve, scene, one.results, False) for curve in curves]
        found.append(one)
    figure = draw(found, appearance, request.columns, request.language)
    return save(figure, request.out, kind, scenes[0].title, appearance.dpi)


def _tell(progress: Progress, done: int, count: int, part: float) -> None:
    progress((done + part) / count)


def make_bands(folder: Path, engines: list[str], request: FigureRequest) -> Path:
    """Draw the bands of an ensemble from its folder and write the figure; engines : "dem",
    "continuum", "exact"; empty: all in the folder."""
    kind, appearance = request.format, STYLES[request.style]
    starts = tuple(one for name in engines for one in (EXACT if name == "exact" else [name]))
    every = bands.statistics_in(folder)
    found = {k: v for k, v in every.items() if not engines or k.startswith(starts)}
    if not found:
        raise SceneError("--engine", ", ".join(engines), None, f"has no results in {folder}")
    width = appearance.widths[request.columns - 1] * MM
    figure = bands.draw(found, width, appearance.rc(request.language))
    return save(figure, request.out, kind, bands.TITLE, appearance.dpi)


def save(figure: Figure, path: Path, kind: str, title: str, dpi: int) -> Path:
    """Write a figure; kind : "pdf", "svg" or "png", the last with `dpi` dots per inch.

    A PDF embeds its fonts as TrueType; letters of an SVG are outlines. Raises SceneError if a file
    of another kind is in its place.
    """
    refuse_foreign(path, BEGINS[kind])
    creator = f"jointwave {version('jointwave')}"
    about: dict[str, dict[str, str | None]] = {
        "pdf": {"Creator": creator, "CreationDate": None},
        "svg": {"Creator": creator, "Date": None},
        "png": {"Software": creator},
    }
    settings: dict[Any, Any] = {"pdf.fonttype": 42, "svg.fonttype": "path", "svg.hashsalt": title}
    with matplotlib.rc_context(settings):
        return write_drawing(path, figure, dpi=dpi, metadata={"Title": title} | about[kind])
