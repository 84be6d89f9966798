"""The report of the paper's figures: in its files, its findings and studies, and as it opens."""

import html
import re
from xml.etree import ElementTree

import meshio
import numpy as np
import pandas as pd
import pytest

from jointwave.cases.effects import active_effects
from jointwave.compare.report.report import build
from jointwave.compare.report.verdict import NOT_CHECKED
from jointwave.compare.studies.effects import reported
from jointwave.compare.studies.study import load
from jointwave.compare.studies.work_precision import REPORTED
from jointwave.compare.text import percent

pytestmark = pytest.mark.slow  # minutes: small pages are opened in test_browser

FIGURES = [f"fig-{number:02d}" for number in range(2, 11)]
ENGINES = ["dem", "continuum-jointed", "continuum-equivalent"]

PEERS = """\
curve,settings,state,message,solves,misfit,total_misfit,seconds,whole,rate,work,beside,stepping_over_ours,whole_over_ours,machine
jointwave blocks,{},done,,rigid blocks,0.01,0.04,0.001,0.8,1e9,1e6,,,,a quiet one
LAMMPS bonds,{},done,,points,0.01,0.04,0.036,0.12,3e7,1e6,jointwave blocks,36,0.15,a quiet one
Yade spheres,,missing,no apt here,cohesive spheres,,,,,,,,,,a quiet one
"""


@pytest.fixture(scope="module")
def built(once):
    """Return the whole report, with a small table of other codes, and what its progress was."""

    def build_whole(folder):
        (table := folder / "points.csv").write_text(PEERS)
        fractions = []
        return build(folder / "report", fractions.append, peers_table=table, hard=False), fractions

    return once("whole-report", build_whole)


@pytest.fixture(scope="module")
def report(built):
    return built[0]


@pytest.fixture(scope="module")
def figures(report):
    return report.file.parent / "figures"


@pytest.fixture(scope="module")
def text(report):
    return report.file.read_text(encoding="utf-8")


def part(text, name):
    found = html.unescape(text[text.index(f'<section id="{name}"') :])
    return found[: found.index("</section>")].replace("\u00a0", " ")


def test_sections_are_in_order_with_all_that_each_has_found(built, text):
    """Ratios and the machine of other codes, every effect, the film's distances; progress ends
    whole, and no half-written file is left."""
    report, fractions = built
    assert fractions == sorted(fractions) and fractions[-1] == 1
    hidden = [path for path in report.file.parent.rglob(".*") if path.is_file()]
    assert len(text.encode()) < 20e6 and not hidden
    found = re.findall(r'<section id="([^"]+)"', text)
    order = ["overview", *FIGURES, "rock-masses", "one-joint", "study-free-pillar", "peers"]
    assert [name for name in found if name in [*order, "effects"]] == [*order, "effects"]
    assert found[-5:] == ["motion", "film", "study-convergence", "study-uniform-chain", "made"]
    others, effects, film = (part(text, name) for name in ("peers", "effects", "film"))
    assert "LAMMPS bonds beside jointwave blocks: stepping 36 times" in others
    assert "a quiet one" in others and "Yade spheres (cohesive spheres): no apt here" in others
    for name, scene in reported():
        assert name in effects
        assert all(effect in effects for effect in active_effects(scene))
    assert "jointwave effects" in effects and "with every effect" in effects
    assert 'src="data:image/gif;base64,' in film and "jointwave animate" in film
    assert "rigid blocks: 2.4 % from the" in film and "jointed rock: 0.34 % from the" in film
    for name in ("oblique-joint", "parallel-joints"):
        shown = part(text, name)
        assert "<img" in shown and "Failed or missing" not in shown
        assert all(words in shown for words in ("rigid blocks: SV wave", "jointed rock: P wave"))


def test_the_overview_is_measured(report):
    """Each line against the misfits of the summary; nobody is beyond a bound of its scene."""
    summary = report.page["summary"].droplevel(0)
    assert list(summary) == [*(f"fig. {number} (%)" for number in range(2, 11)), "one-joint (%)"]
    assert summary.loc["dem ~ lattice", "fig. 3 (%)"] < 0.2  # as the default step promises
    for scene in report.page["scenes"]:
        dem, jointed, bar = (scene.scores[engine] for engine in ENGINES)
        worst = summary[f"{scene.request.label} (%)"] / 100
        others = ("dem ~ jointed-bar", "dem ~ continuum-jointed")
        assert percent(dem.total.judged) in (percent(worst[pair]) for pair in others)
        own = np.nanmax([one.own.judged for one in bar.variants])
        assert percent(own) == percent(worst["continuum-equivalent ~ equivalent-bar"])
        assert {dem.verdict.word, bar.verdict.word} <= {"agrees", "close", "differs"}
        unchecked = scene.request.number in (9, 10)  # without tension nothing else resolves rock
        assert jointed.verdict.word == (NOT_CHECKED.word if unchecked else "agrees")
    (scene,) = report.page["rock_masses"]
    assert scene.scores["continuum-jointed"].verdict.word == "agrees"


def test_all_claims_of_the_paper_hold_and_most_of_its_own_distance_is_dispersion(report, text):
    claims = report.page["claims"]
    assert len(claims) == 19 and {request.name for request, _ in claims} == {*FIGURES}
    assert [claim.claim for _, claim in claims if not claim.holds] == []
    about = report.page["about"]
    assert about.holds and "17.9 %" in about.sentence
    assert "4.0 %" in part(text, "overview") and "dispersion" in part(text, "overview")


@pytest.mark.parametrize("name", [*FIGURES, "one-joint"])
def test_every_scene_has_every_kind_of_picture(figures, text, name):
    drawn = re.findall(rf'<figure id="({name}-[a-z0-9-]+)-figure"', part(text, name))
    kinds = {"scene", "waveforms", "spectra", "energy"}
    kinds |= {"space-time-0"} if name in FIGURES else set()
    assert {f"{name}-{kind}" for kind in kinds} <= set(drawn)
    for figure in drawn:
        for kind in ("svg", "pdf", "csv"):
            assert (figures / f"{figure}.{kind}").stat().st_size > 100
    curves = pd.read_csv(figures / f"{name}-waveforms.csv")
    assert {"dem", "continuum-jointed"} <= {curve.split(" | ")[0] for curve in curves}
    if name in FIGURES:
        assert f"jointwave report guo-li-2002/{name} --out {name}" in part(text, name)


def test_the_pillar_in_motion_is_drawn_listed_and_opened_in_a_viewer(report, figures, text):
    assert "1350 m/s" in part(text, "motion")
    folder = report.file.parent / "fields"
    sets = list(ElementTree.parse(folder / "dem.pvd").getroot().iter("DataSet"))
    assert [float(s.get("timestep")) for s in sets] == pytest.approx(5e-3 * np.arange(8))
    last = meshio.read(folder / sets[-1].get("file"))
    assert list(last.cells_dict) == ["hexahedron"] and last.point_data["displacement"].any()
    table = pd.read_csv(figures / "snapshots.csv", index_col="time (s)")
    assert table.index.tolist() == pytest.approx(5e-3 * np.arange(1, 8))
    count = len(last.cells_dict["hexahedron"])
    assert [*table] == [f"axial stress of block {k} (Pa)" for k in range(count)]
    assert table.abs().max().max() > 1e5 and table.notna().all().all()


@pytest.mark.parametrize("name", REPORTED)
def test_page_shows_what_each_study_found(name, text, report):
    found = part(text, f"study-{name}")
    assert "<img" in found and "Failed or missing" not in found
    body = found[found.index("<tbody>") : found.index("</tbody>")]
    assert all(curve.label in body for curve in load(name).curves)
    points = pd.read_csv(report.file.parent / "studies" / f"{name}.csv")
    assert body.count("<tr>") == len(points)
