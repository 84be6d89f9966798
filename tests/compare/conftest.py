"""Separate storage for timings of tests; and a browser for the tests of pages."""

import shutil
from functools import cache
from itertools import combinations

import pytest
from matplotlib.text import Text

from jointwave.compare.runs import timings


@pytest.fixture(autouse=True)
def own_rates(tmp_path_factory, monkeypatch):
    """Keep what is measured here apart: `--dry-run` foretells from what the machine has done. Few
    tests ask for the file."""

    @cache
    def file():
        return tmp_path_factory.mktemp("rates") / "rates.json"

    monkeypatch.setattr(timings, "_file", file)


@pytest.fixture(scope="module")
def browser():
    """Start a headless Chromium for a file: it takes 200 MB. `make test` installs it."""
    path = shutil.which("chromium") or shutil.which("google-chrome")
    if path is None:
        pytest.skip("no chromium here: the page is not opened")
    from playwright.sync_api import sync_playwright

    with sync_playwright() as player:
        started = player.chromium.launch(executable_path=path, args=["--no-sandbox"])
        yield started
        started.close()


@pytest.fixture
def collisions(monkeypatch):
    """Return a function that lists what a reader of a figure would complain of: text and axes
    beyond its edges, and texts, legends, colour bars and axes that lie over each other."""

    def found(figure):
        texts, draw = {}, Text.draw

        def noted(text, renderer):
            if text.get_visible():
                texts[text] = text.get_text().strip(), text.get_window_extent(renderer)
            return draw(text, renderer)

        with monkeypatch.context() as patch:
            patch.setattr(Text, "draw", noted)
            figure.canvas.draw()
        words = [(said, box, text) for text, (said, box) in texts.items() if said]
        areas = [(str(ax), ax.bbox, ax) for ax in figure.axes if ax.axison]
        areas += [("legend", x.get_window_extent(), x) for x in figure.legends]
        slack = figure.dpi / 72  # a point
        return _outside([*words, *areas], figure.bbox.padded(0.1 * slack)) + [
            f"{one!r} over {other!r}"
            for (one, a, of_one), (other, b, of_other) in combinations([*words, *areas], 2)
            if _meet(a, b, slack) and of_one not in of_other.findobj(Text)
        ]

    return found


def _outside(parts, page):
    return [
        f"{name!r} is outside"
        for name, box, _ in parts
        if box.x0 < page.x0 or box.y0 < page.y0 or box.x1 > page.x1 or box.y1 > page.y1
    ]


def _meet(a, b, slack):
    across = min(a.x1, b.x1) - max(a.x0, b.x0)
    return across > slack and min(a.y1, b.y1) - max(a.y0, b.y0) > slack
