"""What mkdocs calls while it builds: generated parts of pages, and formulas as MathML.

A line `<!-- generated: NAME -->` or `<!-- generated: NAME ARGUMENT -->` of a page is replaced by
what `GENERATED[NAME]` returns. Browsers show MathML by themselves, so no script and no network is
needed to read the formulas.
"""

import logging
import re
from html import unescape
from pathlib import Path

import api
import citation
import commands
import scene_reference
import verification

ROOT = Path(__file__).parents[2]
RESULTS = ROOT / "out" / "tests.xml"

#: What can stand in a page, by name; each is a function of the rest of the line.
GENERATED = {
    "scene-reference": lambda _: scene_reference.page(),
    "verification": lambda _: verification.page(ROOT / "tests", RESULTS),
    "api": lambda module: api.page(ROOT, module),
    "commands": lambda _: commands.page(),
    "citation": lambda _: citation.page(ROOT / "CITATION.cff"),
}
MARK = re.compile(r"^<!-- generated: (\S+) ?(.*?) -->$", re.MULTILINE)
FORMULA = re.compile(r'<(span|div) class="arithmatex">\\([(\[])(.*?)\\[)\]]</\1>', re.DOTALL)


def generated(markdown: str) -> str:
    """Return a page with its generated parts in place; raises KeyError for an unknown one."""
    return MARK.sub(lambda found: GENERATED[found[1]](found[2]), markdown)


def mathml(html: str) -> str:
    """Return a page with its formulas as MathML."""
    from latex2mathml.converter import convert

    def formula(found: re.Match) -> str:
        shown = "inline" if found[2] == "(" else "block"
        return convert(unescape(found[3]).strip(), display=shown)

    return FORMULA.sub(formula, html)


def on_page_markdown(markdown: str, **_) -> str:
    """Put the generated parts into a page before it is rendered."""
    return generated(markdown)


def on_page_content(html: str, page, **_) -> str:
    """Turn the formulas of a rendered page into MathML."""
    text = mathml(html)
    if "merror" in text:
        logging.getLogger("mkdocs").warning("%s: a formula is not LaTeX", page.file.src_uri)
    return text
