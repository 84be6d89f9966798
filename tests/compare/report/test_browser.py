"""The page in a browser: a headless Chromium opens the single file, without a network."""

import io
import re
import shutil
from itertools import pairwise

import numpy as np
import pytest
from pdfminer.high_level import extract_pages
from pdfminer.layout import LTTextContainer
from PIL import Image

from jointwave.compare.report.report import build
from jointwave.compare.report.scenes import PAPER

TITLE = "A title of so many words that it takes more than one line on a narrow screen"
WIDE, NARROW = (1280, 800), (390, 844)
TALL = (1280, 1400)  # every figure fits: for its picture the page is not laid out anew
BOXES = ".scroll, .picture, pre, nav"  # may scroll: else it is clipped
#: Whether each box that may scroll does, and says so.
HINTS = """() => [...document.querySelectorAll(".scroll, .picture")]
  .filter(e => e.checkVisibility())
  .map(e => [e.scrollWidth > e.clientWidth, getComputedStyle(e, "::before").maxHeight !== "0px"])"""
CLIPPED = """boxes => [...document.querySelectorAll(
    "body, h1, h2, h3, p, li, td, th, figcaption, summary, button, code, .grade")]
  .filter(e => e.clientWidth && e.scrollWidth > e.clientWidth + 1
    && (e === document.body || !e.closest(boxes)))
  .map(e => e.tagName + " " + e.textContent.slice(0, 60))"""


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


@pytest.fixture(scope="module")
def report(once):
    """Return the report of two quick scenes, the free pillar for 30 ms: one with variants, and the
    first of them recorded by its velocities."""

    def made(folder):
        own, moving = folder / "short pillar.toml", folder / "moving.toml"
        text = (PAPER / "fig-03.toml").read_text(encoding="utf-8").partition("[[variants]]")[0]
        for key, value in {"duration": 0.03, "title": f'"{TITLE}"'}.items():
            text = re.sub(rf"(?m)^{key} *=.*", f"{key} = {value}", text)
        own.write_text(text + '\n[[variants]]\nname = "zeta 0.05"\njoints.damping_ratio = 0.05\n')
        moving.write_text(re.sub(r"stress *= .*", "velocity = [20.25]", text))
        return build(folder / "report", workers=1, scenes=[str(own), str(moving)])

    return once("small-report", made)


@pytest.fixture(scope="module")
def show(browser, report, tmp_path_factory):
    """Return a function that opens a page, the report's moved to a folder without any of its files;
    and the list of all that the browser complains of. Each is a process of 200 MB."""
    alone = shutil.copy(report.file, tmp_path_factory.mktemp("alone") / "page.html")
    contexts, complaints = [], []

    def opened(size=WIDE, path=alone):
        viewport = dict(zip(("width", "height"), size, strict=True))
        contexts.append(browser.new_context(viewport=viewport, offline=True))
        page = contexts[-1].new_page()
        page.on("console", lambda message: complaints.append(message.text))
        page.on("pageerror", lambda error: complaints.append(str(error)))
        page.on("request", lambda request: _refuse_outside(request.url, path, complaints))
        page.goto(f"file://{path}")
        return page

    opened.complaints, opened.contexts = complaints, contexts
    yield opened
    for context in contexts:
        context.close()


@pytest.fixture
def opened(show):
    """Return the same, for pages of the test's own, which are closed after it."""
    before = len(show.contexts)
    yield show
    while len(show.contexts) > before:
        show.contexts.pop().close()


@pytest.fixture(scope="module")
def page(show):
    """Return the page at its top, with every fold closed, for tests that only look."""
    return show()


@pytest.fixture(scope="module")
def whole(show):
    """Return the page with every fold open, for tests that only look."""
    page = show(TALL)
    unfold(page)
    return page


def _refuse_outside(url, path, complaints):
    if not url.startswith(("data:", "blob:")) and url.split("#")[0] != f"file://{path}":
        complaints.append(f"asks for {url}")


def unfold(page):
    page.evaluate("document.querySelectorAll('details').forEach(d => { d.open = true })")


def shows_picture_and_answer(page, width, height):
    """Fail unless the first screen of an open page shows both."""
    answer = page.locator("ul.lead")
    for box in (page.locator("#overview-picture").bounding_box(), answer.bounding_box()):
        assert box["x"] >= 0 and box["x"] + box["width"] <= width
        assert box["y"] + box["height"] <= height
    assert "time" in answer.inner_text()


def printed(page):
    """Return the number of sides of an open page as printed and their text without any space."""
    sides = list(extract_pages(io.BytesIO(page.pdf(prefer_css_page_size=True))))
    parts = (part for side in sides for part in side if isinstance(part, LTTextContainer))
    return len(sides), "".join("".join(part.get_text().split()) for part in parts)


def spread(png):
    """Return the standard deviation of an image's brightness: 0 where it is blank."""
    return float(np.asarray(Image.open(io.BytesIO(png)).convert("L")).std())


def test_the_page_opens_without_a_complaint_or_a_blank_figure(whole, show):
    assert show.complaints == [] and whole.locator("figure img").count() > 0
    broken = "all => all.filter(i => !i.complete || !i.naturalWidth).map(i => i.alt)"
    assert whole.locator("figure img").evaluate_all(broken) == []
    for figure in whole.locator("figure").all():
        assert spread(figure.screenshot()) > 8, figure.get_attribute("id")


def test_the_first_screen_answers_how_far_apart_and_at_what_cost(page):
    """A picture, a sentence an engine, and a line a scene."""
    shows_picture_and_answer(page, *WIDE)
    table = page.locator("table.overview")
    box = table.bounding_box()
    assert box["y"] + box["height"] <= WIDE[1] and box["x"] + box["width"] <= WIDE[0]
    assert table.locator("tbody tr").count() == 2
    heads = table.locator("thead").inner_text()
    assert all(heads.count(word) == 3 for word in ("misfit, %", "cost", "verdict"))
    said = page.locator("ul.lead li").all_inner_texts()
    starts = ("Rigid blocks are", "Jointed rock, a continuum", "Homogenised rock, a continuum")
    assert len(said) == 3 and all(a.startswith(b) for a, b in zip(said, starts, strict=True))
    assert all("of the exact jointed bar" in one for one in said)
    assert "× the time of the cheapest" in said[2]


def test_a_page_of_ones_own_is_short_and_shows_one_variant_of_each_figure(page):
    """At most 12,000 pixels and three sides and a half a scene; the second variant, spectra and
    energies are in folds, whose titles have the largest imbalance of energy."""
    heights = page.locator("section:has(h2)").evaluate_all("all => all.map(e => e.scrollHeight)")
    assert len(heights) == 3 and sum(heights) < 12_000
    shown = page.locator("#short-pillar h3").all_inner_texts()
    assert shown == [
        *("The scene", "Variants overlaid, engine by engine"),
        "Stress along the pillar over time, undamped",
    ]
    folds = page.locator("#short-pillar summary").all_inner_texts()
    assert "Stress along the pillar over time, ζ = 0.05" in folds
    (energy,) = (one for one in folds if one.startswith("Energy"))
    assert re.search(r"over time: imbalance at most \de-\d\d of the largest work$", energy)
    sides, said = printed(page)
    assert 4 <= sides <= 11 and TITLE.replace(" ", "") in said
    assert page.locator("details[open]").count() == 0 < page.locator("details").count()


def test_solutions_are_in_words_and_verdicts_never_a_colour_alone(whole):
    """On the page; in its scene files and commands solutions have their names."""
    said = whole.evaluate("""() => {
        const copy = document.querySelector("main").cloneNode(true);
        copy.querySelectorAll("pre, code").forEach(e => e.remove());
        return copy.textContent;
    }""")
    assert "rigid blocks ~ jointed bar, exact" in said
    assert not re.findall(r"\bdem\b|continuum-\w+|\blattice\b|jointed-bar", said)
    grades = whole.locator(".grade").all_inner_texts()
    assert len(grades) == 6
    assert all(re.fullmatch(r"[✓≈△▲✗?] [a-z ]+", text) for text in grades)


@pytest.mark.parametrize("size", [WIDE, NARROW], ids=["wide", "narrow"])
def test_no_text_is_clipped_or_lies_over_another(opened, size):
    """The first narrow screen shows the verdict and the cost, too; what scrolls says so."""
    page = opened(size)
    page.wait_for_timeout(200)  # for the timelines of scrolling
    hints = page.evaluate(HINTS)
    assert all(wider == said for wider, said in hints)
    assert any(said for _, said in hints) == (size == NARROW)
    shows_picture_and_answer(page, *size)
    unfold(page)
    assert page.evaluate(OVERLAPS) == []
    assert page.evaluate("document.documentElement.scrollWidth") == size[0]
    assert page.evaluate(CLIPPED, BOXES) == []


def test_headings_follow_each_other_and_everything_has_a_name(whole):
    levels = whole.evaluate("[...document.querySelectorAll('h1,h2,h3,h4')].map(h => +h.tagName[1])")
    assert levels[0] == 1 and levels.count(1) == 1
    assert all(b <= a + 1 for a, b in pairwise(levels))
    unnamed = "all => all.filter(e => !(e.ariaLabel || e.alt || e.textContent.trim())).length"
    assert whole.locator("img, [role=group], a").evaluate_all(unnamed) == 0


def test_files_stand_beside_the_page_and_it_needs_no_script(report):
    """Every link of a figure leads to a file of its kind; nothing else is asked for."""
    text = report.file.read_text(encoding="utf-8")
    links = re.findall(r'<a href="(figures/[^"]+)" download', text)
    kinds = {"svg": b"<?xml", "pdf": b"%PDF", "csv": b""}
    assert len(links) >= 3 * text.count("<figure") and "<script" not in text
    for link in links:
        content = (report.file.parent / link).read_bytes()
        assert len(content) > 100 and content.startswith(kinds[link.rpartition(".")[2]])
    inside = re.findall(r'href="#([^"]+)"', text)
    ids = re.findall(r'\bid="([^"]+)"', text)
    assert {*inside} <= {*ids} and len(ids) == len({*ids})
