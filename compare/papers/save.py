"""A figure for a paper as a file that holds its own fonts: PDF, SVG or PNG."""

from __future__ import annotations

import base64
import io
import re
from html import unescape
from importlib.metadata import version
from pathlib import Path

import matplotlib
from fontTools import subset
from fontTools.ttLib import TTFont
from matplotlib.figure import Figure

from compare import fonts
from compare.output import refuse_foreign, write

#: What a file of each kind begins with: only such a one is replaced.
BEGINS = {"pdf": (b"%PDF",), "svg": (b"<?xml", b"<svg"), "png": (b"\x89PNG",)}
TEXT = re.compile(r"<text[^>]*>([^<]*)</text>")
FAMILY = re.compile(r"'([^']+)'")


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
            dated = {**about, "CreationDate": None}
            return write(path, lambda place: figure.savefig(place, format="pdf", metadata=dated))
        named = {"Title": title, "Software": about["Creator"]}
        return write(
            path, lambda place: figure.savefig(place, format="png", dpi=dpi, metadata=named)
        )


def _svg(figure: Figure, about: dict[str, str]) -> str:
    buffer = io.StringIO()
    figure.savefig(buffer, format="svg", metadata={**about, "Date": None})
    svg = buffer.getvalue()
    letters = unescape("".join(TEXT.findall(svg)))
    styles = " ".join(re.findall(r"font: [^;\"]*", svg))
    used = sorted(set(FAMILY.findall(styles)))
    faces = "".join(_face(family, letters) for family in used)
    return svg.replace("<defs>", f'<defs>\n  <style type="text/css">{faces}</style>', 1)


def _face(family: str, letters: str) -> str:
    """Return the rule that embeds the letters of a font, as WOFF in base64; "" without any."""
    file, number = fonts.file_of(family), fonts.number_of(family)
    wanted = set(letters) - fonts.missing(file, letters)
    if not wanted:
        return ""
    options = subset.Options(flavor="woff", layout_features=["*"], notdef_outline=True)
    font = TTFont(file, fontNumber=number)
    subsetter = subset.Subsetter(options)
    subsetter.populate(text="".join(sorted(wanted)))
    subsetter.subset(font)
    font.flavor = "woff"
    content = io.BytesIO()
    font.save(content)
    data = base64.b64encode(content.getvalue()).decode()
    return f"@font-face{{font-family:'{family}';src:url(data:font/woff;base64,{data})}}"
