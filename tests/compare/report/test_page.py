"""The page from synthetic parts: failures, missing parts, odd characters, tables, scene names."""

import re

import pandas as pd
import pytest

from jointwave.cases.errors import SceneError
from jointwave.compare.figures.export import Drawn
from jointwave.compare.report import scenes
from jointwave.compare.report.claims import Claim
from jointwave.compare.report.report import build, render
from jointwave.compare.report.scenes import PAPER, SceneRequest, asked_for
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
    nothing = dict.fromkeys(("picture", "about"))
    nothing |= {"subtitle": "About", "command": "jointwave report", "machine": "here"}
    nothing |= dict.fromkeys(("claims", "every_scene", "scenes", "rock_masses", "studies"), ())
    nothing |= {"lead": {}, "contents": {}, "versions": {}, "summary": pd.DataFrame()}

    def make(**parts):
        text = render(nothing | parts, tmp_path)
        return re.sub(r"<style>.*?</style>", "", text, flags=re.DOTALL)

    return make


@pytest.fixture
def scene(tmp_path, pillar):
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
        files = {"misfits": tmp_path / "misfits.csv"}
        shown = None, [*figures], [*claims], tables, files, {}, pd.Series(), {}
        return scenes.SolvedScene(request, one, {"dem": 1.0}, *shown)

    return make


def test_an_engine_of_a_later_variant_alone_is_timed_there(tmp_path, in_toml):
    """Its rock is known in that variant only."""
    known = {"name": "known", "rock": {"intact_modulus": 8.64e10}}
    tables = {
        "title": "a variant", "pillar": {"length": 2.0, "side": 0.5, "block": 0.5},
        "rock": {"density": 2400.0, "p_speed": 2200.0, "s_speed": 800.0},
        "load": {"shape": "ricker", "amplitude": 1e6, "period": 0.01},
        "time": {"duration": 0.02}, "record": {"stress": [1.0]}, "variants": [known],
    }  # fmt: skip
    (file := tmp_path / "own.toml").write_text(in_toml(tables))
    found = scenes.solve(SceneRequest(file, "own", "own"), tmp_path)
    assert found.scene.name == "known" and found.seconds["continuum-jointed"] > 0
    assert "cheapest" in scenes.lead([found])["continuum-jointed"]


def test_a_failed_claim_is_red_and_named_at_the_top(page, scene):
    claims = [Claim("They do.", True, "waves pass"), Claim("No.", False, "waves stop")]
    one = scene(claims=claims)
    whole = Claim("It is not so.", False)
    html = page(scenes=[one], claims=[(one.request, claim) for claim in claims], about=whole)
    assert '<li class="holds"><strong>waves pass.</strong> They do.</li>' in html
    assert '<li class="fails"><strong>waves stop: does not hold.</strong> No.</li>' in html
    assert "1 of 2 claims do not hold" in html
    assert '<a href="#fig-05">fig. 5, waves stop</a>' in html
    assert '<p class="fails">' in html and "It is not so.</p>" in html


def test_text_of_scenes_is_escaped(page, scene):
    html = page(scenes=[scene(title="<b>a & b</b>", toml="x = '<i></script>'")])
    assert "&lt;b&gt;a &amp; b&lt;/b&gt;" in html and "&lt;i&gt;&lt;/script&gt;" in html


def test_tables_have_headings_labels_and_numbers(page):
    """Percentages to three digits, others to four, whole numbers whole, a dash for none."""
    index = pd.MultiIndex.from_tuples([("kind", "one"), ("kind", "two")], names=["kind", "pair"])
    numbers = {"a (%)": [12.3456, 1e-4], "b": [0.123456, float("nan")], "c": [7, 1_000_000]}
    html = page(summary=pd.DataFrame(numbers, index))
    body = html[html.index("<tbody>", html.index("Every pair")) :]
    cells = re.findall(r"<t[hd][^>]*>([^<]*)</t[hd]>", body)
    assert cells[:9] == ["kind", "one", "12.3", "0.1235", "7", "two", "&lt; 0.001", "–", "1000000"]


def test_a_study_shows_its_findings_failures_and_points(page, figure):
    table = pd.DataFrame({"value": [0.5]})
    found = Summary("s", "S", table, ["Off by 1 %."], ["dem: no"], [], {}, figure("s"), "A note.")
    html = page(studies=[section("study", found, "jointwave study s", id="study-s")])
    assert '<section id="study-s">' in html and "Failed or missing: dem: no." in html
    assert all(x in html for x in ("Off by 1\u00a0%.", "A note.", "<td>0.5</td>"))


def test_a_folded_picture_is_closed_and_one_without_its_file_is_an_error(page, scene, figure):
    more = figure("more")._replace(caption="What is seen.", folded=True)
    html = page(scenes=[scene([more])])
    assert "<details><summary>A figure</summary>" in html and "<details open" not in html
    more.file("svg").unlink()
    with pytest.raises(FileNotFoundError):
        page(scenes=[scene([more])])


def test_without_names_the_scenes_are_the_papers_figures_and_shipped_rock_masses():
    paper, rock = asked_for(()), asked_for(scenes.ROCK_MASSES)
    assert [one.number for one in paper] == list(range(2, 11)) and paper[0].label == "fig. 2"
    assert [one.label for one in rock] == ["one-joint"]
    assert not {one.name for one in rock} & {one.name for one in paper}


def test_every_scene_has_a_name_of_its_own_that_is_fit_for_files(tmp_path):
    """A copy of a figure of the paper is none of its figures, of which claims are made."""
    names = ("a/my pillar", "b/my pillar", "overview", "岩", "fig-04")
    files = [tmp_path / f"{name}.toml" for name in names]
    for file in files:
        file.parent.mkdir(exist_ok=True)
        file.write_text((PAPER / "fig-04.toml").read_text())
    found = asked_for([*map(str, files), str(files[0]), "guo-li-2002/fig-03"])
    assert [(one.name, one.number) for one in found] == [
        *(("my-pillar", None), ("my-pillar-2", None), ("overview-2", None)),
        *(("scene-2", None), ("fig-04", None), ("fig-03", 3)),
    ]


def test_a_scene_that_is_not_there_is_said_before_anything_is_written(tmp_path):
    with pytest.raises(SceneError, match=r"none\.toml"):
        build(tmp_path / "page", scenes=["none.toml"])
    assert not (tmp_path / "page").exists()
