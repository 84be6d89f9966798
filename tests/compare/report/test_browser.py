"""The page in a browser: a headless Chromium opens the single file, without a network."""

import io
import re
import shutil
from itertools import pairwise
from xml.etree import ElementTree

import numpy as np
import pandas as pd
import pytest
from PIL import Image

WIDE, NARROW = (1280, 800), (390, 844)
TALL = (1280, 1400)  # every figure fits: for its picture the page is not laid out anew
BOXES = ".scroll, .static, pre, nav"  # may scroll; whatever else is wider than its place is clipped


@pytest.fixture(scope="module")
def report(small_report):
    return small_report()


@pytest.fixture(scope="module")
def alone(report, tmp_path_factory):
    """Return the page moved to a folder without any of its files."""
    return shutil.copy(report.file, tmp_path_factory.mktemp("alone") / "page.html")


@pytest.fixture(scope="module")
def show(browser, alone):
    """Return a function that opens the page, and the list of all that the browser complains of."""
    contexts, complaints = [], []

    def opened(size=WIDE, path=alone, **options):
        context = browser.new_context(
            viewport=dict(zip(("width", "height"), size, strict=True)), offline=True, **options
        )
        contexts.append(context)
        page = context.new_page()
        page.on("console", lambda message: complaints.append(message.text))
        page.on("pageerror", lambda error: complaints.append(str(error)))
        page.on("request", lambda request: _refuse_outside(request.url, path, complaints))
        page.goto(path.as_uri() if hasattr(path, "as_uri") else f"file://{path}")
        return page

    opened.complaints, opened.contexts = complaints, contexts
    yield opened
    for context in contexts:
        context.close()


@pytest.fixture
def opened(show):
    """Return the same, for pages of the test's own; each is a process of 200 MB until it is
    closed."""
    show.complaints.clear()
    before = len(show.contexts)
    yield show
    while len(show.contexts) > before:
        show.contexts.pop().close()


@pytest.fixture(scope="module")
def _page(show):
    return show(permissions=["clipboard-read", "clipboard-write"])


@pytest.fixture
def page(_page):
    """Return a page at its top, with every fold closed."""
    fold(_page)
    return _page


@pytest.fixture(scope="module")
def _whole(show):
    page = show(TALL)
    unfold(page)
    return page


@pytest.fixture
def whole(_whole):
    """Return the page with every fold open, for tests that only look."""
    yield _whole
    _whole.emulate_media(media="screen")


def _refuse_outside(url, path, complaints):
    if not url.startswith(("data:", "blob:")) and url.split("#")[0] != f"file://{path}":
        complaints.append(f"asks for {url}")


def unfold(page):
    """Open every fold."""
    page.evaluate("document.querySelectorAll('details').forEach(d => { d.open = true })")


def fold(page):
    """Close every fold, and return to the top."""
    page.evaluate("document.querySelectorAll('details').forEach(d => { d.open = false })")
    page.evaluate("scrollTo(0, 0)")


def spread(png):
    """Return the standard deviation of an image's brightness: 0 where it is blank."""
    return float(np.asarray(Image.open(io.BytesIO(png)).convert("L")).std())


def test_the_page_opens_without_a_complaint(whole, show):
    assert show.complaints == [] and whole.locator("figure img").count() > 0
    broken = "all => all.filter(i => !i.complete || !i.naturalWidth).map(i => i.alt)"
    assert whole.locator("figure img").evaluate_all(broken) == []


def test_the_first_screen_answers_how_far_apart_and_at_what_cost(page, report):
    table = page.locator("table.overview")
    box = table.bounding_box()
    assert box["y"] + box["height"] <= WIDE[1] and box["x"] + box["width"] <= WIDE[0]
    assert table.locator("tbody tr").count() == 2
    heads = table.locator("thead").inner_text().replace("\u00a0", " ")
    assert all(heads.count(word) == 3 for word in ("own %", "finest %", "cost", "verdict"))
    lead = page.locator("ul.lead").inner_text()
    for engine in report.page.overview.engines:
        assert engine in lead
    assert lead.count("from the finest physics") == 3 and "× the time of the cheapest" in lead


def test_a_verdict_is_never_a_colour_alone(whole):
    grades = whole.locator(".grade").all_inner_texts()
    assert len(grades) == 6
    assert all(re.fullmatch(r"[✓≈△▲✗?] [a-z ]+", text) for text in grades)


@pytest.mark.slow
def test_every_download_is_a_whole_file_of_its_kind(opened, report):
    page = opened(accept_downloads=True)
    unfold(page)
    links = page.locator(".files a").all()
    figures = page.locator("figure").count()
    assert len(links) == 3 * figures > 3
    for link in links:
        page.wait_for_timeout(150)  # Chromium holds back who saves twenty files in a row at once
        with page.expect_download() as waiting:
            link.click()
        name = link.get_attribute("download")
        assert waiting.value.suggested_filename == name
        content = waiting.value.path().read_bytes()
        beside = report.file.parent / "figures" / name
        CHECKS[name.rpartition(".")[2]](content, beside)
    assert opened.complaints == []


def _check_svg(content, beside):
    tree = ElementTree.fromstring(content)
    assert tree.tag == "{http://www.w3.org/2000/svg}svg"
    there = ElementTree.parse(beside).getroot()
    path = "{http://www.w3.org/2000/svg}path"
    assert len(list(tree.iter(path))) == len(list(there.iter(path))) > 5


def _check_pdf(content, beside):
    assert content.startswith(b"%PDF") and content == beside.read_bytes()
    assert b"/Type3" in content  # letters as embedded outlines


def _check_csv(content, beside):
    assert content == beside.read_bytes() and len(pd.read_csv(beside)) > 1


CHECKS = {"svg": _check_svg, "pdf": _check_pdf, "csv": _check_csv}


def test_no_figure_is_blank_on_screen(whole):
    for figure in whole.locator("figure").all():
        assert spread(figure.screenshot()) > 8, figure.get_attribute("id")


def test_the_page_prints_what_is_not_folded(page, printed, title):
    """Folds stay closed, and titles are whole; each scene takes at most three sides and a half."""
    sides, said = printed(page)
    assert 4 <= sides <= 11 and title.replace(" ", "") in said
    page.evaluate("dispatchEvent(new Event('beforeprint'))")
    assert page.locator("details[open]").count() == 0 < page.locator("details").count()


def test_no_two_captions_show_the_same_picture_or_numbers(whole, report):
    """On paper pixel by pixel, where none is blank, and file by file; what two scenes share is
    drawn once and linked to."""
    page = whole
    page.emulate_media(media="print")
    found = {}
    for figure in page.locator("figure").all():
        name = figure.get_attribute("id").removesuffix("-figure")
        numbers = (report.file.parent / "figures" / f"{name}.csv").read_bytes()
        picture = figure.locator(".static").screenshot()
        assert spread(picture) > 8, name
        for seen in (picture, numbers):
            assert found.setdefault(seen, name) == name
    links = page.locator("#moving p a[href^='#short-pillar']")
    assert links.all_inner_texts() == ["short-pillar: Energy over time"]
    assert page.locator(links.get_attribute("href")).count() == 1


def test_every_variant_has_a_diagram_of_its_own_under_its_name(whole):
    heads = whole.locator("h3").all_inner_texts()
    for words in ("Stress along", "Velocity along"):
        for variant in ("undamped", "ζ = 0.05"):
            assert f"{words} the pillar over time, {variant}" in heads


CLIPPED = """boxes => [...document.querySelectorAll(
    "body, h1, h2, h3, p, li, td, th, figcaption, summary, button, code, .grade")]
  .filter(e => e.clientWidth && e.scrollWidth > e.clientWidth + 1
    && (e === document.body || !e.closest(boxes)))
  .map(e => e.tagName + " " + e.textContent.slice(0, 60))"""


@pytest.mark.parametrize("size", [WIDE, NARROW], ids=["wide", "narrow"])
def test_no_text_is_clipped_or_lies_over_another(
    opened, whole, overlaps, shows_verdict_and_cost, size
):
    """The first narrow screen shows the verdict and the cost, too."""
    page = whole if size == WIDE else opened(size)
    if size == NARROW:
        shows_verdict_and_cost(page, *size)
    unfold(page)
    assert overlaps(page) == []
    assert page.evaluate("document.documentElement.scrollWidth") == size[0]
    assert page.evaluate(CLIPPED, BOXES) == []


def test_keys_reach_everything_and_are_seen_where_they_are(whole):
    """Tab goes through every link, button and summary in turn, and out again."""
    page = whole
    page.evaluate("scrollTo(0, 0); document.activeElement.blur()")
    wanted = page.evaluate(
        "[...document.querySelectorAll('a[href], button, summary')]"
        ".filter(e => e.checkVisibility() && !e.disabled).length"
    )
    step = """() => { const e = document.activeElement; e.dataset.reached = 1;
      return [e.tagName, e.className, getComputedStyle(e).outlineStyle] }"""
    page.keyboard.press("Tab")
    first = page.evaluate(step)
    assert first[1] == "skip"
    for _ in range(3 * wanted):
        tag, name, outline = page.evaluate(step)
        if tag == "BODY":
            break
        assert outline != "none", (tag, name)
        page.keyboard.press("Tab")
    missed = page.evaluate(
        "[...document.querySelectorAll('a[href], button, summary')]"
        ".filter(e => e.checkVisibility() && !e.dataset.reached).map(e => e.outerHTML.slice(0, 90))"
    )
    assert missed == []


def test_headings_follow_each_other_and_everything_has_a_name(whole):
    page = whole
    levels = page.evaluate("[...document.querySelectorAll('h1,h2,h3,h4')].map(h => +h.tagName[1])")
    assert levels[0] == 1 and levels.count(1) == 1
    assert all(b <= a + 1 for a, b in pairwise(levels))
    unnamed = "e => e.filter(x => !(x.getAttribute('aria-label') || x.textContent.trim())).length"
    assert page.locator("[role=img], [role=group], button, a").evaluate_all(unnamed) == 0
    ids = page.evaluate("[...document.querySelectorAll('[id]')].map(e => e.id)")
    assert len(ids) == len(set(ids))


def test_the_command_of_a_scene_is_copied(page):
    page.locator("#moving .copy").click()
    page.locator("#moving .copy", has_text="Copied").wait_for()
    copied = page.evaluate("navigator.clipboard.readText()")
    assert re.fullmatch(r"jointwave report \S+/moving\.toml --out moving", copied)


def test_without_scripts_figures_stand_still_and_links_lead_to_files(opened, report):
    page = opened(path=report.file, java_script_enabled=False)
    for figure in page.locator("section > figure").all():
        assert figure.locator(".static img").is_visible()
    for link in page.locator("figure .files a").all():
        assert (report.file.parent / link.get_attribute("href")).stat().st_size > 100
    assert page.locator(".copy:visible").count() == 0
