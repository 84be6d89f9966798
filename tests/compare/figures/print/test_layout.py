"""Figures for papers hold all that is written in them, whole and beside each other."""

from itertools import combinations

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from pdfminer.high_level import extract_pages
from pdfminer.layout import LAParams, LTTextLine

from cases.errors import SceneError
from compare.figures import fonts
from compare.figures.print.draw import WORDS, draw
from compare.figures.print.layout import STYLES, wrapped
from compare.figures.print.make import save

FEW = ("dem", "continuum-jointed", "jointed-bar")
POINT = 25.4 / 72  # mm
LANGUAGES = ["en", "zh"] if fonts.chinese_font() else ["en"]
LONG = "the same joint after cycle {}"
#: receivers, variants, columns, language: one, the most of each, and what once was cut off.
SIZES = [(1, 1, 1), (3, 1, 2), (5, 2, 2), (8, 1, 1), (8, 4, 2), (2, 4, 1), (1, 4, 2), (7, 3, 2)]


@pytest.mark.parametrize("receivers, variants, columns", SIZES)
def test_nothing_is_cut_off_or_overprinted(many, collisions, receivers, variants, columns):
    appearance, language = STYLES["journal"], LANGUAGES[(receivers + variants) % len(LANGUAGES)]
    figure = draw(many(receivers, variants, FEW, LONG), appearance, columns, language)
    assert len(figure.axes) == receivers * variants
    assert collisions(figure) == []
    assert figure.get_figheight() * 25.4 <= appearance.tallest + 1e-6


@pytest.mark.parametrize("columns", [1, 2])
@pytest.mark.parametrize("style", STYLES)
def test_a_legend_of_every_solution_fits(many, collisions, style, columns):
    assert collisions(draw(many(2, 2), STYLES[style], columns, LANGUAGES[-1])) == []


@settings(max_examples=5, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(size=st.floats(-9, 9), duration=st.floats(1e-3, 1e3))
def test_numbers_on_the_axes_stay_apart(many, collisions, size, duration):
    """Whatever they are."""
    keys = {"load__amplitude": 10**size, "time__duration": duration}
    found = many(3, 1, ("dem",), record__interval=duration / 100, **keys)
    assert collisions(draw(found, STYLES["journal"], 2, "en")) == []


def test_more_panels_than_a_page_holds_are_refused_in_one_line(many):
    with pytest.raises(SceneError, match="32 panels do not fit 240 mm: choose --columns 2, a "):
        draw(many(8, 4, ("dem",)), STYLES["journal"], 1, "en")


def lines_of(path):
    """Return the page's box and every line of text of a PDF with its box, points."""
    (page,) = extract_pages(path, laparams=LAParams(char_margin=1.0))
    found, left = [], [page]
    while left:
        part = left.pop()
        if isinstance(part, LTTextLine):
            found.append((part.get_text().strip(), part.bbox))
        elif hasattr(part, "__iter__"):
            left.extend(part)
    return page.bbox, found


@pytest.mark.parametrize("columns", [1, 2])
@pytest.mark.parametrize("language", LANGUAGES)
def test_the_written_pdf_holds_all_words(many, tmp_path, columns, language):
    """Each within the page and beside the others, as another program finds them in the file."""
    found = many(2, 2, name=LONG)
    appearance, words = STYLES["journal"], WORDS[language]
    path = save(
        draw(found, appearance, columns, language), tmp_path / "figure.pdf", "pdf", "A title", 600
    )
    (left, bottom, right, top), lines = lines_of(path)
    assert (right - left) * POINT == pytest.approx(appearance.widths[columns - 1], abs=0.1)
    text = "".join("".join(said for said, _ in lines).split())
    for name in found[0].results:
        assert "".join(words.solution(name).split()) in text
    assert text.count(words.time.replace(" ", "")) == columns
    for said, (x0, y0, x1, y1) in lines:
        assert x0 >= left and x1 <= right and y0 >= bottom and y1 <= top, said
    for (one, a), (other, b) in combinations(lines, 2):
        across = min(a[2], b[2]) - max(a[0], b[0])
        assert across < 1 or min(a[3], b[3]) - max(a[1], b[1]) < 2, (one, other)


@pytest.mark.parametrize("name", ["a name of several words {}" * 6, "w" * 150, "软弱层与节理" * 12])
def test_a_name_of_any_length_is_whole(many, collisions, name):
    if name[0] == "软" and len(LANGUAGES) == 1:
        pytest.skip("no font with Chinese characters here")
    figure = draw(many(2, 2, ("dem",), name), STYLES["journal"], 1, "en")
    assert collisions(figure) == []
    title = figure.axes[-1].get_title(loc="left").replace("\n", "").replace(" ", "")
    assert name.replace("{}", "1").replace(" ", "") in title


def test_lines_break_at_spaces_and_never_before_a_stop():
    def fits(line):
        return len(line) <= 10

    assert wrapped("stress at y\u00a0=\u00a02\u00a0m, undamped", fits) == [
        "stress at", "y\u00a0=\u00a02\u00a0m,", "undamped"]  # fmt: skip
    assert wrapped("应力应力应力应力应力，原场景", fits) == ["应力应力应力应力应", "力，原场景"]
    assert wrapped("w" * 25, fits) == ["w" * 10, "w" * 10, "w" * 5]


def test_variants_begin_rows_and_times_are_written_once_a_column(many):
    figure = draw(many(5, 2), STYLES["journal"], 2, "en")
    rows = {round(ax.get_position().y0, 3) for ax in figure.axes}
    assert len(rows) == 6
    labels = [ax.get_xlabel() for ax in figure.axes]
    assert labels == ["", "", "", "time (ms)", "", "", "", "", "time (ms)", "time (ms)"]


def test_the_motion_is_drawn_and_the_title_says_without_what(many):
    """A prestress of ten times the wave neither flattens it nor is forgotten."""
    (found,) = many(2, 1, ("dem", "lattice"))
    waves = 1e-6 * found.results["dem"]["stress"].values
    for result in found.results.values():
        result["stress"] = result["stress"] + 1e7
        result.attrs |= {"starts": "prestressed", "prestress": 1e7}
    figure = draw([found], STYLES["journal"], 1, "en")
    for ax, wave in zip(figure.axes, waves, strict=True):
        assert "minus the static 10\u00a0MPa" in ax.get_title(loc="left").replace("\n", " ")
        assert ax.get_ylabel() == "stress (MPa)"
        assert ax.lines[1].get_ydata() == pytest.approx(wave, abs=1e-8)
