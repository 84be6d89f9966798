"""The page from synthetic parts: its text for failures, missing parts, and odd characters."""

import re
from concurrent.futures import Executor, Future
from pathlib import Path

import pandas as pd
import pytest

from compare.figures.export import Drawn
from compare.figures.figure import SceneFigure
from compare.report.findings import Finding
from compare.report.overview import Overview
from compare.report.render import Page, RockMasses, render
from compare.report.section import PAPER, SceneRequest, Section, Shown, begin, finish
from compare.report.tables import Table
from compare.studies.summary import Summary, text_table

EMPTY = text_table(["point"], [])


@pytest.fixture
def figure(tmp_path):
    """Return a function that gives a figure and writes its files."""

    def make(name):
        for kind in ("svg", "pdf", "csv", "nc"):
            (tmp_path / f"{name}.{kind}").write_text("x")
        (tmp_path / f"{name}-map.csv").write_text("x")
        return Drawn(name, "A figure", tmp_path)

    return make


@pytest.fixture
def page(tmp_path):
    """Return a function that renders a page of nothing but the given parts."""

    def make(**parts):
        nothing = Page("About", Overview([]), Table([], {}), [], "jointwave report", "here", {})
        return render(nothing.__class__(**{**nothing.__dict__, **parts}), tmp_path)

    return make


@pytest.fixture
def section(tmp_path, figure):
    """Return a function that gives a scene with these findings."""
    empty = Table(["pair"], {})
    file = tmp_path / "fig-05-misfits.csv"
    file.write_text("x")

    def make(findings, **changes):
        request = SceneRequest(PAPER / "fig-05.toml", "five", "fig-05")
        about = request, "Ends", "source", "toml"
        one = Section(*about, [shown(figure("ends"))], file, file, findings, *[empty] * 5, {})
        return one._replace(**changes)

    return make


def shown(drawn, folded=False):
    """Return a figure as shown on the page."""
    return Shown(drawn.title, "What is seen.", folded, drawn)


def done(result):
    """Return a future that has its result."""
    future = Future()
    future.set_result(result)
    return future


def test_rock_masses_stand_with_their_scenes_and_studies(page, section, figure):
    """Also in the contents; without them nothing of them is on the page."""
    table = text_table(["angle", "off"], [("rigid blocks: P wave", ["30", "1.0e-02"])])
    parts = figure("oblique-joint"), "A note.", "Off: from the closed form."
    study = Summary(
        "oblique-joint", "At one joint", table, ["Off by 1 %."], ["dem: no"], [], {}, *parts
    )
    html = page(rock_masses=RockMasses(Overview([]), [section([])], [study]))
    assert re.findall(r'<section id="([^"]+)"', html) == [
        *("overview", "rock-masses", "fig-05", "oblique-joint", "made")
    ]
    contents = html.partition("</nav>")[0]
    assert 'href="#rock-masses"' in contents and 'href="#oblique-joint">At one joint' in contents
    assert "jointwave study oblique-joint" in html and "Failed points: dem: no." in html
    assert all(
        text in html for text in ("Off by 1 %.".replace(" %", "\u00a0%"), "A note.", "1.0e-02")
    )
    assert "rock-masses" not in page()


def test_a_study_has_a_place_beside_a_scene_of_its_name(page, section, figure):
    """The contents lead to each of them."""
    study = Summary("fig-05", "Work", EMPTY, [], [], [], {}, figure("work"), timed=True)
    html = page(sections=[section([])], studies=[study])
    places = re.findall(r'\bid="([^"]+)"', html)
    assert len(set(places)) == len(places)
    links = re.findall(r'href="#([^"]+)"', html.partition("</nav>")[0])
    assert set(links) <= set(places) and {"fig-05", "study-fig-05"} <= set(links)


def test_a_failed_claim_is_red_and_named_at_the_top(page, section):
    findings = [Finding("waves pass", "They do.", True), Finding("waves stop", "No.", False)]
    html = page(sections=[section(findings)])
    assert '<li class="holds"><strong>waves pass.</strong> They do.</li>' in html
    assert '<li class="fails"><strong>waves stop: does not hold.</strong> No.</li>' in html
    assert "1 of 2 claims do not hold" in html.replace("\n", " ")
    assert '<a href="#fig-05">fig. 5, waves stop</a>' in html


def test_a_claim_about_the_whole_that_fails_is_red(page):
    html = page(about=Finding("claim", "It is not so.", False))
    assert '<p class="fails">It is not so.</p>' in html


def test_text_of_scenes_is_escaped(page, section):
    html = page(sections=[section([], title="<b>a & b</b>", toml="x = '<i></script>'")])
    assert "&lt;b&gt;a &amp; b&lt;/b&gt;" in html and "&lt;i&gt;&lt;/script&gt;" in html


def test_without_a_table_of_other_codes_one_line_says_how_to_get_it(page, figure):
    study = Summary("s", "S", EMPTY, [], [], [], {}, figure("s"), timed=True)
    html = page(studies=[study], peers_file="a.csv")
    assert "run <code>make bench-peers</code>, then <code>jointwave report" in html
    assert "--peers a.csv</code>" in html


def test_hard_cases_stand_with_their_margins_and_what_failed(page, figure):
    table = text_table(["engine", "value", "bound"], [("step", ["dem", "1", "2"])])
    said, failed = ["3 of 4 rows hold."], ["step, dem: 3 above 2"]
    drawn = figure("stability")
    found = Summary("stability", "Hard cases", table, said, failed, [], {}, drawn, about="A note.")
    html = page(stability=found)
    assert '<a href="#stability">' in html and "<li>3 of 4 rows hold.</li>" in html
    assert 'class="fails">Rows that do not hold: step, dem: 3 above 2.' in html
    assert "<td" in html.split('id="stability"')[1]


def test_a_page_holds_the_licences_of_what_it_holds_of_others(page, section):
    assert "Bitstream Vera" in page(sections=[section([])])


def test_a_file_that_is_not_there_is_an_error_not_a_dead_link(page, section, figure):
    one = figure("gone")
    Path(one.file("pdf")).unlink()
    with pytest.raises(FileNotFoundError):
        page(sections=[section([], figures=[shown(one)])])


def test_no_picture_is_drawn_twice(page, section, figure, tmp_path):
    """A later one of the same numbers, whatever it is called, is a link to the first."""
    drawn = []

    class Draws(Executor):
        def submit(self, work, folder, picture):
            drawn.append(picture.name)
            return done(figure(picture.name))

    requests = [SceneRequest(PAPER / f"{name}.toml", "it", name) for name in ("fig-05", "fig-06")]
    tables = [pd.DataFrame({"a (m)": values}) for values in ([1.0], [1.0], [2.0])]
    named = zip(("first", "second", "third"), tables, strict=True)
    pictures = [SceneFigure(n, "A figure", "Seen.", lambda: None, table) for n, table in named]
    on_page = zip((requests[0], requests[1], requests[1]), pictures, strict=True)
    found = begin(tmp_path, on_page, Draws())
    assert drawn == ["first", "third"]
    sections = [section([], request=r, figures=finish(found[r.name])) for r in requests]
    html = page(sections=sections)
    assert html.count("<figure id=") == 2 and 'id="second-figure"' not in html
    assert 'The same picture as <a href="#first-figure">fig. 5: A figure</a>.' in html


def test_a_folded_picture_is_closed_until_it_is_opened(page, section, figure):
    html = page(sections=[section([], figures=[shown(figure("more"), folded=True)])])
    assert "<details><summary>A figure</summary>" in html and "<details open" not in html
