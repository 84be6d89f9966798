"""Text of the page: whole and beside other text, on a wide and a narrow screen and on paper."""

import io
from functools import cache

import pytest
from pdfminer.high_level import extract_pages
from pdfminer.layout import LTTextContainer

from compare.report.report import build

WIDE, NARROW = (1280, 800), (390, 844)
MOST_SIDES = 35  # of the whole report in print
#: Receivers and variants.
SIZES = [pytest.param(size, marks=pytest.mark.slow) for size in ((1, 1), (5, 2), (1, 4), (8, 4))]

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


@pytest.fixture(scope="module", params=[None, *SIZES], ids=str)
def page(request, once, small_report, own_scene):
    """Return the page of the small report, or of one scene with receivers and variants."""
    if request.param is None:
        return small_report().file
    receivers, variants = request.param
    names = [f"the same joints with dashpots of ratio {0.05 * i}" for i in range(1, variants)]
    places = [2.5 * (i + 1) for i in range(receivers)]

    def made(folder):
        (own := folder / "own.toml").write_text(own_scene(names, stress=places))
        return build(folder / "report", workers=1, scenes=[str(own)]).file

    return once(f"page-{receivers}-{variants}", made)


@pytest.fixture(scope="module")
def _shown(browser, page):
    contexts = []

    @cache
    def show(size):
        context = browser.new_context(
            viewport=dict(zip(("width", "height"), size, strict=True)), reduced_motion="reduce"
        )
        contexts.append(context)
        opened = context.new_page()
        opened.goto(page.as_uri())
        for figure in opened.locator("figure[data-plot]").all():
            if not figure.is_visible():  # in a fold
                continue
            figure.scroll_into_view_if_needed()
            figure.locator(".chart .main-svg").first.wait_for(timeout=60_000)
        return opened

    yield show
    for context in contexts:
        context.close()


@pytest.fixture
def shown(_shown):
    """Return a function that gives the page in a window of a size, every chart drawn, at its top
    and with every fold closed."""

    def show(size):
        opened = _shown(size)
        opened.evaluate("document.querySelectorAll('details').forEach(d => { d.open = false })")
        opened.evaluate("scrollTo(0, 0)")
        return opened

    return show


@pytest.mark.parametrize("size", [WIDE, NARROW], ids=["wide", "narrow"])
def test_no_text_lies_over_another(shown, size):
    opened = shown(size)
    opened.evaluate("document.querySelectorAll('details').forEach(d => { d.open = true })")
    assert opened.evaluate(OVERLAPS) == []
    assert opened.evaluate("document.documentElement.scrollWidth") == size[0]


def test_the_first_narrow_screen_shows_verdict_and_cost(shown):
    opened = shown(NARROW)
    for place in (opened.locator(".grade").first, opened.locator("ul.lead")):
        box = place.bounding_box()
        assert box["x"] >= 0 and box["x"] + box["width"] <= NARROW[0]
        assert box["y"] + box["height"] <= NARROW[1]
    assert "time" in opened.locator("ul.lead").inner_text()


def test_on_paper_titles_are_whole_and_details_folded(shown, title):
    opened = shown(WIDE)
    sides = list(extract_pages(io.BytesIO(opened.pdf(prefer_css_page_size=True))))
    assert len(sides) < MOST_SIDES
    assert opened.locator("details[open]").count() == 0
    said = "".join(
        "".join(part.get_text().split())
        for side in sides
        for part in side
        if isinstance(part, LTTextContainer)
    )
    assert title.replace(" ", "") in said
