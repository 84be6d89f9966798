"""From scenes to a figure's file: solve what is asked for, and draw it."""

from pathlib import Path
from typing import Any, NamedTuple

from cases.errors import SceneError
from cases.kinds import AnyScene
from compare.engines import Progress, applies, names, solve
from compare.figures.print.appearance import STYLES
from compare.figures.print.draw import draw
from compare.figures.print.save import BEGINS, save
from compare.misfit.alignment import lay_beside
from compare.misfit.pairs import Comparison
from compare.runs.jobs import names_of


class FigureRequest(NamedTuple):
    """What `jointwave figure` is to write; kind : None where the file's name says it."""

    style: str
    columns: int
    kind: str | None
    language: str
    out: Path

    @property
    def format(self) -> str:
        """pdf, svg or png; raises SceneError where there is no such, or the name says another."""
        named = self.out.suffix.removeprefix(".").lower()
        if self.kind is None and named not in BEGINS:
            raise SceneError("--out", str(self.out), None, f"must end in .{', .'.join(BEGINS)}")
        if self.kind is not None and named != self.kind:
            raise SceneError("--out", str(self.out), None, f"must end in .{self.kind}")
        return named


def make(
    scenes: list[AnyScene],
    runs: list[tuple[str, str | None]],
    curves: list[Any],
    request: FigureRequest,
    progress: Progress,
) -> Path:
    """Solve scenes, draw them with the curves of others, and write the figure.

    runs : (engine, model) each, see `compare.runs.jobs`; empty: all that apply.
    """
    kind, appearance = request.format, STYLES[request.style]
    wanted = [_solvers(scene, runs) for scene in scenes]
    found, done = [], 0
    for scene, solvers in zip(scenes, wanted, strict=True):
        comparison = Comparison(scene)
        for name in solvers:
            comparison.results[name] = solve(name, scene)
            done += 1
            progress(done / sum(map(len, wanted)))
        given = [curve for curve in curves if curve.holds_for(scene)]
        comparison.besides += [lay_beside(c, scene, comparison.results, False) for c in given]
        found.append(comparison)
    figure = draw(found, appearance, request.columns, request.language)
    return save(figure, request.out, kind, scenes[0].title, appearance.dpi)


def _solvers(scene: AnyScene, runs: list[tuple[str, str | None]]) -> list[str]:
    if not runs:
        return [name for name in names() if applies(name, scene)]
    found = [name for engine, model in runs for name in names_of(engine, model, scene)]
    return list(dict.fromkeys(found))
