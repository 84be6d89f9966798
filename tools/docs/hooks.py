"""Hooks of mkdocs: generated parts of pages, and formulas as MathML.

A line `<!-- generated: NAME -->` or `<!-- generated: NAME ARGUMENT -->` of a page is followed by
the text of `GENERATED[NAME]`, up to a line `<!-- end -->` if the page contains that text. As a
program it writes the text into docs/reference. MathML needs no script and no network.
"""

import re
from html import unescape
from pathlib import Path

import api
import commands
import notebooks
import scene_reference

from jointwave.cases.schema.rock_mass import RockMass

ROOT = Path(__file__).parents[2]

#: Generators of parts by name; each is a function of the rest of the line.
GENERATED = {
    "scene-reference": lambda _: scene_reference.page(),
    "rock-mass-reference": lambda _: scene_reference.page(RockMass, "rock-"),
    "api": lambda module: api.page(ROOT, module),
    "commands": lambda _: commands.page(),
    "example": lambda name: notebooks.page(name),
}
MARK = re.compile(
    r"^<!-- generated: (?P<name>\S+) ?(?P<argument>[^\n]*?) -->$"
    r"(?:\n\n.*?\n<!-- end -->$)?",  # text written by this program
    re.MULTILINE | re.DOTALL,
)
WRITTEN = "<!-- generated: {} -->\n\n{}\n\n<!-- end -->"
FORMULA = re.compile(r'<(span|div) class="arithmatex">\\([(\[])(.*?)\\[)\]]</\1>', re.DOTALL)


#: Functions, after which MathML sets no space.
FUNCTION = re.compile(r"<mi>(sin|cos|tan|cosh|arcsin|log|tanh)</mi>(?!<mo)")
#: Vertical bars, which MathML would space and stretch like operators.
BAR = re.compile(r"<mo[^>]*>(&#x0007C;|&#x02016;)</mo>")


def generated(markdown: str) -> str:
    """Return a page with its generated parts inserted; raises KeyError for an unknown part."""
    return MARK.sub(_part, markdown)


def written_out(markdown: str) -> str:
    """Return a page with its generated parts between marks, so that they can be updated."""
    return MARK.sub(
        lambda found: WRITTEN.format(f"{found['name']} {found['argument']}".strip(), _part(found)),
        markdown,
    )


def _part(found: re.Match) -> str:
    return GENERATED[found["name"]](found["argument"])


def mathml(html: str) -> str:
    """Return a page with its formulas as MathML."""
    from latex2mathml.converter import convert

    def formula(found: re.Match) -> str:
        shown = "inline" if found[2] == "(" else "block"
        converted = convert(unescape(found[3]).strip(), display=shown)
        spaced = FUNCTION.sub(r'<mi>\1</mi><mspace width="0.17em"/>', converted)
        return BAR.sub(r'<mo lspace="0" rspace="0" stretchy="false">\1</mo>', spaced)

    return FORMULA.sub(formula, html)


def on_page_markdown(markdown: str, **_) -> str:
    """Insert the generated parts into a page before it is rendered."""
    return generated(markdown)


def on_page_content(html: str, **_) -> str:
    """Turn the formulas of a rendered page into MathML."""
    return mathml(html)


if __name__ == "__main__":
    for page in sorted((ROOT / "docs" / "reference").glob("*.md")):
        page.write_text(written_out(page.read_text(encoding="utf-8")), encoding="utf-8")
