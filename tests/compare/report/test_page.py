"""The page from synthetic parts: failures, missing parts, odd characters, tables."""

import re

import pandas as pd
import pytest

from jointwave.compare.figures.export import Drawn
from jointwave.compare.report.claims.claim import Claim
from jointwave.compare.report.page import render
from jointwave.compare.report.scenes import PAPER, SceneRequest, SolvedScene
from jointwave.compare.report.sections import section
from jointwave.compare.studies.experiment import Summary


@pytest.fixture
def figure(tmp_path):
    """Return a function that gives a figure and writes its files."""

    def make(name):
        for kind in ("svg", "pdf", "csv"):
            (tmp_path / f"{name}.{kind}").write_text("x")
        return Drawn(name, "A figure", tmp_path)

    return make


@pytest.fixture
def page(tmp_path):
    """Return a function that renders a page of nothing but the given parts, without its style."""
    nothing = {
        "subtitle": "About",
        "picture": None,
        "lead": {},
        "summary": pd.DataFrame(),
        "claims": [],
        "about": None,
        "every_scene": [],
        "scenes": [],
        "rock_masses": [],
        "studies": [],
        "contents": {},
        "command": "jointwave report",
        "machine": "here",
        "versions": {},
    }

    def make(**parts):
        text = render(nothing | parts, tmp_path)
        return re.sub(r"<style>.*?</style>", "", text, flags=re.DOTALL)

    return make


@pytest.fixture
def scene(tmp_path, figure, pillar):
    """Return a function that gives a scene of the page with pictures, claims and texts."""
    (tmp_path / "misfits.csv").write_text("x")
    empty = pd.DataFrame()

    def make(figures=(), claims=(), title="Ends", toml=""):
        file = PAPER / "fig-05.toml"
        if toml:
            (file := tmp_path / "own.toml").write_text(toml)
        request, one = SceneRequest(file, "fig-05", "fig-05"), pillar(title=title)
        tables = dict.fromkeys(("verdicts", "distances", "readings", "runs"), empty)
        tables["reasons"] = pd.DataFrame(columns=["solution", "variants", "why"])
        tables["misfits"] = pd.DataFrame({"undamped (%)": [0.5]}, pd.Index(["a ~ b"], name="pair"))
        shown = [one._replace(caption="What is seen.", folded=folded) for one, folded in figures]
        files = {"misfits": tmp_path / "misfits.csv"}
        about = {}, pd.Series(), {}
        return SolvedScene(
            request, one, {"dem": 1.0}, None, shown, list(claims), tables, files, *about
        )

    return make


def test_a_failed_claim_is_red_and_named_at_the_top(page, scene):
    claims = [Claim("They do.", True, "waves pass"), Claim("No.", False, "waves stop")]
    one = scene(claims=claims)
    html = page(scenes=[one], claims=[(one.request, claim) for claim in claims])
    assert '<li class="holds"><strong>waves pass.</strong> They do.</li>' in html
    assert '<li class="fails"><strong>waves stop: does not hold.</strong> No.</li>' in html
    assert "1 of 2 claims do not hold" in html
    assert '<a href="#fig-05">fig. 5, waves stop</a>' in html


def test_a_claim_about_the_whole_that_fails_is_red(page):
    html = page(about=Claim("It is not so.", False))
    assert '<p class="fails">' in html and "It is not so.</p>" in html


def test_solutions_and_pairs_of_them_are_in_words(page):
    index = pd.Index(["dem ~ jointed-bar", "lab.csv ~ continuum-jointed"], name="pair")
    html = page(summary=pd.DataFrame({"fig. 2 (%)": [0.5, 1.0], "of": ["lattice", "no"]}, index))
    assert "rigid blocks ~ jointed bar, exact" in html and "lab.csv ~ jointed rock" in html
    assert "<td>rigid blocks, exact</td>" in html


def test_text_of_scenes_is_escaped(page, scene):
    html = page(scenes=[scene(title="<b>a & b</b>", toml="x = '<i></script>'")])
    assert "&lt;b&gt;a &amp; b&lt;/b&gt;" in html and "&lt;i&gt;&lt;/script&gt;" in html


def test_tables_have_headings_labels_and_numbers(page):
    """Percentages to three digits, others to four, whole numbers whole, a dash for none."""
    index = pd.MultiIndex.from_tuples([("kind", "one"), ("kind", "two")], names=["kind", "pair"])
    numbers = {"a (%)": [12.3456, 1e-4], "b": [0.123456, float("nan")], "c": [7, 1_000_000]}
    html = page(summary=pd.DataFrame(numbers, index))
    cells = re.findall(
        r"<t[hd][^>]*>([^<]*)</t[hd]>", html[html.index("<tbody>", html.index("Every pair")) :]
    )
    assert cells[:9] == ["kind", "one", "12.3", "0.1235", "7", "two", "&lt; 0.001", "–", "1000000"]


def test_a_study_shows_its_findings_failures_and_points(page, figure):
    table = pd.DataFrame({"value": [0.5]})
    found = Summary("s", "S", table, ["Off by 1 %."], ["dem: no"], [], {}, figure("s"), "A note.")
    study = section("study", found, "jointwave study s", id="study-s")
    html = page(studies=[study])
    assert '<section id="study-s">' in html and "Failed or missing: dem: no." in html
    assert all(x in html for x in ("Off by 1\u00a0%.", "A note.", "<td>0.5</td>"))


def test_a_picture_whose_file_is_not_there_is_an_error(page, scene, figure):
    gone = figure("gone")
    gone.file("svg").unlink()
    with pytest.raises(FileNotFoundError):
        page(scenes=[scene([(gone, False)])])


def test_a_folded_picture_is_closed_until_it_is_opened(page, scene, figure):
    html = page(scenes=[scene([(figure("more"), True)])])
    assert "<details><summary>A figure</summary>" in html and "<details open" not in html
