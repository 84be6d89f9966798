"""Text of pages of many receivers and variants: whole and beside other text, on a wide and a narrow
screen and on paper. The small report is looked at in test_browser."""

from functools import cache

import pytest

from compare.report.report import build

WIDE, NARROW = (1280, 800), (390, 844)
MOST_SIDES = 35  # of the whole report in print
#: Receivers and variants.
SIZES = [(1, 1), (5, 2), (1, 4), (8, 4)]

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module", params=SIZES, ids=str)
def page(request, once, own_scene):
    """Return the page of one scene with receivers and variants."""
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
        return opened

    yield show
    for context in contexts:
        context.close()


@pytest.fixture
def shown(_shown):
    """Return a function that gives the page in a window of a size, at its top and with every fold
    closed."""

    def show(size):
        opened = _shown(size)
        opened.evaluate("document.querySelectorAll('details').forEach(d => { d.open = false })")
        opened.evaluate("scrollTo(0, 0)")
        return opened

    return show


@pytest.mark.parametrize("size", [WIDE, NARROW], ids=["wide", "narrow"])
def test_no_text_lies_over_another(shown, overlaps, size):
    opened = shown(size)
    opened.evaluate("document.querySelectorAll('details').forEach(d => { d.open = true })")
    assert overlaps(opened) == []
    assert opened.evaluate("document.documentElement.scrollWidth") == size[0]


def test_the_first_narrow_screen_shows_verdict_and_cost(shown, shows_verdict_and_cost):
    shows_verdict_and_cost(shown(NARROW), *NARROW)


def test_on_paper_titles_are_whole_and_details_folded(shown, printed, title):
    opened = shown(WIDE)
    sides, said = printed(opened)
    assert sides < MOST_SIDES and title.replace(" ", "") in said
    assert opened.locator("details[open]").count() == 0
