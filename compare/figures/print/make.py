"""Print figures with embedded fonts: solve the scenes, draw and write them."""

import base64
import io
import logging
from importlib.metadata import version
from pathlib import Path
from typing import Any, NamedTuple

import matplotlib
from fontTools import subset
from fontTools.ttLib import TTFont
from matplotlib.figure import Figure
from matplotlib.text import Text

from cases.errors import SceneError
from cases.kinds import AnyScene
from compare.engines import EXACT, Progress, applies, names, solve
from compare.figures import bands, fonts
from compare.figures.export import write_drawing
from compare.figures.print.draw import draw, families_of
from compare.figures.print.layout import MM, STYLES
from compare.misfit.alignment import lay_beside
from compare.misfit.pairs import Comparison
from compare.runs.jobs import names_of
from compare.runs.output import refuse_foreign, write_text

#: First bytes of a file of each kind: only such a file is overwritten.
BEGINS = {"pdf": (b"%PDF",), "svg": (b"<?xml", b"<svg"), "png": (b"\x89PNG",)}


def save(figure: Figure, path: Path, kind: str, title: str, dpi: int) -> Path:
    """Write a figure; kind : "pdf", "svg" or "png", the last with `dpi` dots per inch.

    Raises SceneError if a file of another kind is in its place.
    """
    refuse_foreign(path, BEGINS[kind])
    about = {"Title": title, "Creator": f"jointwave {version('jointwave')}"}
    with matplotlib.rc_context({"pdf.fonttype": 42, "svg.fonttype": "none", "svg.hashsalt": title}):
        if kind == "svg":
            return write_text(path, _svg(figure, about))
        if kind == "pdf":
            _refuse_postscript(figure)
            return write_drawing(path, figure, metadata={**about, "CreationDate": None})
        named = {"Title": title, "Software": about["Creator"]}
        return write_drawing(path, figure, dpi=dpi, metadata=named)


def _svg(figure: Figure, about: dict[str, str]) -> str:
    buffer = io.StringIO()
    figure.savefig(buffer, format="svg", metadata={**about, "Date": None})
    faces = "".join(_face(family, letters) for family, letters in _letters(figure).items())
    style = f'<defs>\n  <style type="text/css">{faces}</style>'
    return buffer.getvalue().replace("<defs>", style, 1)


def _letters(figure: Figure) -> dict[str, str]:
    """Return the letters of a figure by font family: the first family that has them."""
    text = "".join(part.get_text() for part in figure.findobj(Text))
    families = {family: None for part in figure.findobj(Text) for family in part.get_fontfamily()}
    found = {}
    for family in families:
        missing = fonts.missing(fonts.file_of(family), text)
        found[family] = "".join(sorted(set(text) - missing))
        text = "".join(missing)
    return {family: letters for family, letters in found.items() if letters.strip()}


def _refuse_postscript(figure: Figure) -> None:
    """Raise SceneError if a PDF cannot embed a font as TrueType."""
    for family in _letters(figure):
        if not fonts.is_true_type(family):
            allowed = (
                f"cannot embed {family}, whose outlines are PostScript: write .svg or .png, or "
                "apt install fonts-wqy-microhei"
            )
            raise SceneError("figure", "", None, allowed)


def _face(family: str, letters: str) -> str:
    """Return the CSS rule that embeds the letters of a font, as WOFF in base64."""
    logging.getLogger("fontTools").setLevel(logging.ERROR)  # it reports dropped tables
    options = subset.Options(flavor="woff", layout_features=["*"], notdef_outline=True)
    font = TTFont(fonts.file_of(family), fontNumber=fonts.number_of(family), recalcTimestamp=False)
    subsetter = subset.Subsetter(options)
    subsetter.populate(text=letters)
    subsetter.subset(font)
    font.flavor = "woff"
    content = io.BytesIO()
    font.save(content)
    data = base64.b64encode(content.getvalue()).decode()
    return f"@font-face{{font-family:'{family}';src:url(data:font/woff;base64,{data})}}"


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
    """Solve scenes, draw them with external curves, and write the figure.

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


def make_bands(folder: Path, engines: list[str], request: FigureRequest) -> Path:
    """Draw the bands of an ensemble from its folder and write the figure; engines : "dem",
    "continuum", "exact"; empty: all in the folder."""
    kind, appearance = request.format, STYLES[request.style]
    starts = tuple(one for name in engines for one in (EXACT if name == "exact" else [name]))
    found = {
        k: v for k, v in bands.statistics_in(folder).items() if not engines or k.startswith(starts)
    }
    if not found:
        raise SceneError("--engine", ", ".join(engines), None, f"has no results in {folder}")
    width = appearance.widths[request.columns - 1] * MM
    figure = bands.draw(found, width, appearance.rc(families_of(request.language)))
    return save(figure, request.out, kind, bands.TITLE, appearance.dpi)


def _solvers(scene: AnyScene, runs: list[tuple[str, str | None]]) -> list[str]:
    if not runs:
        return [name for name in names() if applies(name, scene)]
    found = [name for engine, model in runs for name in names_of(engine, model, scene)]
    return list(dict.fromkeys(found))
