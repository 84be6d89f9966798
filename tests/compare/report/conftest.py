"""Pages for the tests of the report, each made once."""

import io
import re

import pytest
from pdfminer.high_level import extract_pages
from pdfminer.layout import LTTextContainer

from jointwave.compare.report.report import build
from jointwave.compare.report.scenes import PAPER

TITLE = "A title of so many words that it takes more than one line on a narrow screen"

#: Every pair of lines of text of which more than 2 pixels lie over each other in both directions.
OVERLAPS = """() => {
  const lines = [];
  const walk = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  while (walk.nextNode()) {
    const node = walk.currentNode, owner = node.parentElement;
    if (!node.data.trim() || owner.closest("script, style, title, .skip, nav")) continue;
    if (!owner.checkVisibility({opacityProperty: true, visibilityProperty: true})) continue;
    const range = document.createRange();
    range.selectNodeContents(node);
    for (const r of range.getClientRects())
      if (r.width > 2 && r.height > 2) lines.push([r, node.data.trim().slice(0, 40), owner]);
  }
  lines.sort((a, b) => a[0].top - b[0].top);
  const found = [];
  lines.forEach(([a, said, owner], i) => {
    for (let j = i + 1; j < lines.length && lines[j][0].top < a.bottom - 2; j++) {
      const [b, other, owned] = lines[j];
      const across = Math.min(a.right, b.right) - Math.max(a.left, b.left);
      const down = Math.min(a.bottom, b.bottom) - b.top;
      if (across > 2 && down > 4 && owner !== owned) found.push(`${said} over ${other}`);
    }
  });
  return found;
}"""


@pytest.fixture(scope="session")
def overlaps():
    """Return a function that lists the lines of text of an open page that lie over each other."""
    return lambda page: page.evaluate(OVERLAPS)


@pytest.fixture(scope="session")
def shows_picture_and_answer():
    """Return a function that fails unless the first screen of an open page shows both."""

    def check(page, width, height):
        picture, answer = page.locator("#overview-picture"), page.locator("ul.lead")
        for box in (picture.bounding_box(), answer.bounding_box()):
            assert box["x"] >= 0 and box["x"] + box["width"] <= width
            assert box["y"] + box["height"] <= height
        assert "time" in page.locator("ul.lead").inner_text()

    return check


@pytest.fixture(scope="session")
def printed():
    """Return a function that prints an open page: the number of sides and their text without any
    space."""

    def read(page):
        sides = list(extract_pages(io.BytesIO(page.pdf(prefer_css_page_size=True))))
        parts = (part for side in sides for part in side if isinstance(part, LTTextContainer))
        return len(sides), "".join("".join(part.get_text().split()) for part in parts)

    return read


@pytest.fixture(scope="session")
def title():
    """Return the title of the scenes of one's own."""
    return TITLE


@pytest.fixture(scope="session")
def own_scene():
    """Return a function of changed lines and names of variants: the free pillar for 30 ms."""

    def text(variants=(), **lines):
        free = (PAPER / "fig-03.toml").read_text(encoding="utf-8").partition("[[variants]]")[0]
        for key, value in {"duration": 0.03, "title": f'"{TITLE}"', **lines}.items():
            free = re.sub(rf"(?m)^{key} *=.*", f"{key} = {value}", free)
        for i, name in enumerate(variants):
            ratio = f"joints.damping_ratio = {0.05 * (i + 1)}"
            free += f'\n[[variants]]\nname = "{name}"\n{ratio}\n'
        return free

    return text


@pytest.fixture(scope="session")
def small_report(once, own_scene):
    """Return the report of two quick scenes: one with variants, and the same recorded by its
    velocities."""

    def made(folder):
        own, moving = folder / "short pillar.toml", folder / "moving.toml"
        own.write_text(text := own_scene(["zeta 0.05"]))
        moving.write_text(re.sub(r"stress *= .*", "velocity = [20.25]", text))
        return build(folder / "report", workers=1, scenes=[str(own), str(moving)])

    return lambda: once("small-report", made)
