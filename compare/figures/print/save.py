"""A figure for a paper as a file that holds its own fonts: PDF, SVG or PNG."""

from __future__ import annotations

import base64
import io
import logging
from importlib.metadata import version
from pathlib import Path

import matplotlib
from fontTools import subset
from fontTools.ttLib import TTFont
from matplotlib.figure import Figure
from matplotlib.text import Text

from cases.errors import SceneError
from compare.figures import fonts
from compare.runs.output import refuse_foreign, write

#: What a file of each kind begins with: only such a one is replaced.
BEGINS = {"pdf": (b"%PDF",), "svg": (b"<?xml", b"<svg"), "png": (b"\x89PNG",)}


def save(figure: Figure, path: Path, kind: str, title: str, dpi: int) -> Path:
    """Write a figure; kind : "pdf", "svg" or "png", which has so many dots an inch.

    Raises SceneError where a file of another kind is in its place.
    """
    refuse_foreign(path, BEGINS[kind])
    about = {"Title": title, "Creator": f"jointwave {version('jointwave')}"}
    with matplotlib.rc_context({"pdf.fonttype": 42, "svg.fonttype": "none", "svg.hashsalt": title}):
        if kind == "svg":
            return write(path, lambda place: place.write_text(_svg(figure, about), "utf-8"))
        if kind == "pdf":
            _refuse_postscript(figure)
            dated = {**about, "CreationDate": None}
            return write(path, lambda place: figure.savefig(place, format="pdf", metadata=dated))
        named = {"Title": title, "Software": about["Creator"]}
        return write(
            path, lambda place: figure.savefig(place, format="png", dpi=dpi, metadata=named)
        )


def _svg(figure: Figure, about: dict[str, str]) -> str:
    buffer = io.StringIO()
    figure.savefig(buffer, format="svg", metadata={**about, "Date": None})
    faces = "".join(_face(family, letters) for family, letters in _letters(figure).items())
    style = f'<defs>\n  <style type="text/css">{faces}</style>'
    return buffer.getvalue().replace("<defs>", style, 1)


def _letters(figure: Figure) -> dict[str, str]:
    """Return the letters that a drawn figure takes from each family: the first that has them."""
    text = "".join(part.get_text() for part in figure.findobj(Text))
    families = {family: None for part in figure.findobj(Text) for family in part.get_fontfamily()}
    found = {}
    for family in families:
        missing = fonts.missing(fonts.file_of(family), text)
        found[family] = "".join(sorted(set(text) - missing))
        text = "".join(missing)
    return {family: letters for family, letters in found.items() if letters.strip()}


def _refuse_postscript(figure: Figure) -> None:
    """Raise SceneError where a PDF cannot take a font as TrueType."""
    for family in _letters(figure):
        if not fonts.is_true_type(family):
            allowed = (
                f"cannot embed {family}, whose outlines are PostScript: write .svg or .png, or "
                "apt install fonts-wqy-microhei"
            )
            raise SceneError("figure", "", None, allowed)


def _face(family: str, letters: str) -> str:
    """Return the rule that embeds the letters of a font, as WOFF in base64."""
    logging.getLogger("fontTools").setLevel(logging.ERROR)  # it tells of tables that it leaves out
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
