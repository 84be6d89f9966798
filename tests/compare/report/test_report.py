"""The report of the paper's figures: in its files, its findings and studies, and as it opens."""

import html
import re
from xml.etree import ElementTree

import meshio
import numpy as np
import pandas as pd
import pytest

from jointwave import cases
from jointwave.cases.effects import active_effects
from jointwave.compare.report.report import build
from jointwave.compare.report.scenes import PAPER
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
    return once("whole-report", build_whole)


def build_whole(folder):
    table = folder / "points.csv"
    table.write_text(PEERS, encoding="utf-8")
    fractions = []
    return build(folder / "report", fractions.append, peers_table=table, hard=False), fractions


@pytest.fixture(scope="module")
def report(built):
    return built[0]


@pytest.fixture(scope="module")
def fractions(built):
    return built[1]


@pytest.fixture(scope="module")
def text(report):
    """Return the page's HTML."""
    return report.file.read_text(encoding="utf-8")


def part(text, name):
    """Return a section of the page."""
    found = html.unescape(text[text.index(f'<section id="{name}"') :])
    return found[: found.index("</section>")]


@pytest.mark.parametrize("name", ["fig-03", "fig-05", "fig-06", "fig-07", "fig-08", "fig-09"])
def test_variants_of_a_figure_share_a_pair_of_axes_an_engine(report, name):
    """Waveforms and residuals, at each receiver."""
    svg = (report.file.parent / "figures" / f"{name}-variants.svg").read_text(encoding="utf-8")
    record = cases.load(PAPER / f"{name}.toml")[0].record
    receivers = len(record.stress) + len(record.velocity)
    assert svg.count('id="axes_') == 2 * len(ENGINES) * receivers


def curves_of(report, name):
    """Return the waveforms of a scene as pictured."""
    return pd.read_csv(report.file.parent / "figures" / f"{name}-waveforms.csv")


def test_the_page_begins_with_a_picture_and_an_answer(report, browser, shows_picture_and_answer):
    """At 1280 by 800; then a line a scene. The page is at most 25,000 pixels long without
    the film, which takes 600."""
    page = browser.new_page(viewport={"width": 1280, "height": 800})
    page.goto(report.file.as_uri())
    shows_picture_and_answer(page, 1280, 800)
    box = page.locator("table.overview").bounding_box()
    assert box["x"] + box["width"] <= 1280
    rows = page.locator("table.overview tbody tr").all_inner_texts()
    assert len(rows) == len(FIGURES) + 1 and all(row.count("×") == 3 for row in rows[:-1])
    lead = page.locator("#overview ul.lead").inner_text().replace("\u00a0", " ")
    assert "Rigid blocks are within 4.0 % of the exact jointed bar" in lead
    assert "for the rock mass" in lead and "the time of the cheapest" in lead
    assert page.evaluate("document.documentElement.scrollHeight") < 25_600
    page.close()


def test_studies_stand_after_figures_and_convergence_in_an_appendix(text):
    found = re.findall(r'<section id="([^"]+)"', text)
    order = ["overview", *FIGURES, "rock-masses", "one-joint", "study-free-pillar", "effects"]
    assert [name for name in found if name in order] == order
    assert found[-3:] == ["study-convergence", "study-uniform-chain", "made"]
    assert found[-5:-3] == ["motion", "film"]


def test_the_overview_is_measured(report):
    """Each line against the misfits of the summary; nobody is beyond a bound of its scene."""
    summary = report.summary.droplevel(0)
    for scene in report.page["scenes"]:
        dem, jointed, bar = (scene.scores[engine] for engine in ENGINES)
        label = scene.request.label
        assert percent(dem.total.judged) in (
            summary.loc["dem ~ jointed-bar", label],
            summary.loc["dem ~ continuum-jointed", label],
        )
        own = np.nanmax([one.own.judged for one in bar.variants])
        assert percent(own) == summary.loc["continuum-equivalent ~ equivalent-bar", label]
        assert {dem.verdict.word, bar.verdict.word} <= {"agrees", "close", "differs"}
        unchecked = scene.request.number in (9, 10)  # without tension nothing else resolves rock
        assert jointed.verdict.word == (NOT_CHECKED.word if unchecked else "agrees")


def test_most_of_the_papers_own_distance_is_dispersion(report, text):
    about = report.page["about"]
    assert about.holds and "17.9 %" in about.sentence
    assert "4.0\u00a0%" in part(text, "overview") and "dispersion" in part(text, "overview")


@pytest.mark.parametrize("name", FIGURES)
def test_every_scene_has_every_kind_of_picture(report, text, name):
    """In the order of the page, each with its files and at least both engines in it."""
    found = re.findall(rf'<figure id="({name}-[a-z0-9-]+)-figure"', part(text, name))
    heads = re.findall(r"<h3>(.*?)</h3>|<summary>(.*?)</summary>", part(text, name))
    titles = " ".join(a or b for a, b in heads)
    for words in ("The scene", "Waveforms", "along the pillar over time", "spectra", "Energy"):
        assert words in titles
    for figure in found:
        for kind in ("svg", "pdf", "csv"):
            assert (report.file.parent / "figures" / f"{figure}.{kind}").stat().st_size > 100
    assert {"dem", "continuum-jointed"} <= {x.split(" | ")[0] for x in curves_of(report, name)}
    assert f"jointwave report guo-li-2002/{name} --out {name}" in part(text, name)


def test_rock_masses_stand_beside_the_studies(report, text):
    """A scene with every kind of figure, and scattering at joints, solver by solver."""
    found = re.findall(r'<figure id="(one-joint-[a-z-]+)-figure"', part(text, "one-joint"))
    names = ("scene", "waveforms", "spectra", "energy")
    assert {f"one-joint-{name}" for name in names} <= set(found)
    (scene,) = report.page["rock_masses"]
    assert scene.scores["continuum-jointed"].verdict.word == "agrees"
    for name in ("oblique-joint", "parallel-joints"):
        shown = part(text, name)
        assert "<img" in shown and "Failed or missing" not in shown
        assert all(words in shown for words in ("rigid blocks: SV wave", "jointed rock: P wave"))


def test_csv_holds_the_load_itself(report):
    """At y = 0 the rigid blocks' stress is the load: 1 MPa times sin(2 pi t / 10 ms), 6 digits."""
    table = pd.read_csv(report.file.parent / "figures" / "fig-02-waveforms.csv")
    (column,) = (c for c in table if c.startswith("dem | stress at y = 0 m"))
    one = table[table["time (s)"] < 0.01]
    sine = 1e6 * np.sin(2 * np.pi * one["time (s)"] / 0.01)
    np.testing.assert_allclose(one[column], sine, atol=1.0)


def test_misfits_are_written_as_numbers(report):
    table = pd.read_csv(report.file.parent / "figures" / "fig-03-misfits.csv")
    chosen = table[(table["pair"] == "dem ~ equivalent-bar") & (table["variant"] == "undamped")]
    assert chosen["relative L2"].item() == pytest.approx(0.179, abs=5e-4)
    assert set(table["kind"]) == {"numerical error", "modelling error", "between engines"}


def test_page_asks_for_nothing(report, text):
    """It is below 20 MB, asks for nothing, and every link of its own leads somewhere."""
    assert len(text.encode()) < 20e6
    assert not re.findall(r'\bsrc="(?!data:)|@import|url\(|<script', text)
    for link in re.findall(r'href="([^"#][^"]*)"', text):
        there = (report.file.parent / html.unescape(link)).is_file()
        assert there or link.startswith("data:"), link
    ids = re.findall(r'\bid="([^"]+)"', text)
    assert len(ids) == len(set(ids)) and set(re.findall(r'href="#([^"]+)"', text)) <= set(ids)


def test_the_pillar_in_motion_is_drawn_and_its_blocks_are_listed(report, text):
    found = part(text, "motion")
    assert "1350\u00a0m/s" in found
    table = pd.read_csv(report.file.parent / "figures" / "snapshots.csv", index_col="time (s)")
    assert table.index.tolist() == pytest.approx(5e-3 * np.arange(1, 8))
    assert [*table] == [f"axial stress of block {k} (Pa)" for k in range(len(table.columns))]
    assert len(table.columns) == found_blocks(report)
    assert table.abs().max().max() > 1e5 and table.notna().all().all()


def test_the_film_is_in_the_page_with_the_engines_distances(text):
    found = part(text, "film").replace("\u00a0", " ")
    assert 'src="data:image/gif;base64,' in found and "jointwave animate" in found
    assert "rigid blocks: 2.4 % from the" in found and "jointed rock: 0.34 % from the" in found


def found_blocks(report):
    """The number of blocks in the snapshots of the pillar in motion."""
    folder = report.file.parent / "fields"
    (first, *_) = ElementTree.parse(folder / "dem.pvd").getroot().iter("DataSet")
    return len(meshio.read(folder / first.get("file")).cells_dict["hexahedron"])


def test_the_pillar_in_motion_can_be_opened_in_a_viewer(report):
    folder = report.file.parent / "fields"
    sets = list(ElementTree.parse(folder / "dem.pvd").getroot().iter("DataSet"))
    assert [float(s.get("timestep")) for s in sets] == pytest.approx(5e-3 * np.arange(8))
    last = meshio.read(folder / sets[-1].get("file"))
    assert list(last.cells_dict) == ["hexahedron"] and last.point_data["displacement"].any()


def test_report_leaves_no_half_written_files(report):
    files = [path.name for path in report.file.parent.rglob("*") if path.is_file()]
    drawn = [*REPORTED, "peers", "effects", "snapshots"]
    kinds = ("svg", "pdf", "png", "csv")
    assert {f"{name}.{kind}" for name in drawn for kind in kinds} <= set(files)
    assert {f"{name}-misfits.csv" for name in FIGURES} <= set(files)
    assert {f"{i:04d}.vtu" for i in range(8)} | {f"{name}.nc" for name in REPORTED} <= set(files)
    assert not [name for name in files if name.startswith(".")]


@pytest.mark.parametrize("name", REPORTED)
def test_page_shows_what_each_study_found(name, text, report):
    """Its diagram, and every point of its table below the label of its curve."""
    found = part(text, f"study-{name}")
    assert "<img" in found and "Failed or missing" not in found
    body = found[found.index("<tbody>") : found.index("</tbody>")]
    assert all(curve.label in body for curve in load(name).curves)
    points = pd.read_csv(report.file.parent / "studies" / f"{name}.csv")
    assert body.count("<tr>") == len(points)


def test_page_shows_other_codes_beside_the_free_pillar(text):
    """Ratios, equations of each code, the machine, and missing codes with reasons."""
    found = part(text, "peers")
    assert "LAMMPS bonds beside jointwave blocks: stepping 36 times" in found
    assert "a quiet one" in found and "Yade spheres (cohesive spheres): no apt here" in found
    order = [text.index(f'<section id="{name}">') for name in ("study-free-pillar", "peers")]
    assert order == sorted(order) and text.count("<section", *order) == 1


def test_page_shows_what_every_effect_costs_and_is_worth(text):
    """Every scene and effect of the section, in the table and in the diagram."""
    found = part(text, "effects")
    for name, scene in reported():
        assert name in found
        assert all(effect in found for effect in active_effects(scene))
    assert "jointwave effects" in found and "with every effect" in found


def test_progress_ends_whole(report, fractions):
    assert fractions == sorted(fractions)
    assert fractions[-1] == 1


def test_summary_has_a_column_a_figure_and_a_row_a_pair(report):
    summary = report.summary.droplevel(0)
    assert list(summary) == [*(f"fig. {number}" for number in range(2, 11)), "one-joint"]
    assert float(summary.loc["dem ~ lattice", "fig. 3"]) < 0.2  # in %, as the default step promises


def test_all_claims_of_the_paper_hold(report):
    claims = report.page["claims"]
    assert len(claims) == 19 and {request.name for request, _ in claims} == {*FIGURES}
    assert [claim.claim for _, claim in claims if not claim.holds] == []
