"""The report as its reader meets it: in a browser, in its files, and with claims that fail."""

import html
import io
import re
import shutil
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from matplotlib.colors import to_rgb
from PIL import Image
from selenium import webdriver
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.by import By

import cases
from cases.effects import active_effects
from compare.fieldfiles import read_pvd
from compare.findings import Finding
from compare.page import Section, render
from compare.pairs import Comparison
from compare.panels import curve_table, variant_names
from compare.report import SCENES, _key, build
from compare.studies.section import REPORTED, StudySection
from compare.studies.study import load
from compare.style import style
from compare.tables import Table
from compare.worth_study import reported

FIGURES = [f"fig-{number:02d}" for number in range(2, 11)]
SCALE = 2  # device pixels a CSS pixel: dashes get pixels of their pure colour
FLAGS = (
    "--headless=new --no-sandbox --disable-gpu --no-first-run --disable-background-networking "
    f"--disable-component-update --disable-sync --window-size=1280,1000 "
    f"--force-device-scale-factor={SCALE}"
)

PEERS = """\
curve,settings,state,message,solves,misfit,total_misfit,seconds,whole,rate,work,beside,stepping_over_ours,whole_over_ours,machine
jointwave blocks,{},done,,rigid blocks,0.01,0.04,0.001,0.8,1e9,1e6,,,,a quiet one
LAMMPS bonds,{},done,,points,0.01,0.04,0.036,0.12,3e7,1e6,jointwave blocks,36,0.15,a quiet one
Yade spheres,,missing,no apt here,cohesive spheres,,,,,,,,,,a quiet one
"""


@pytest.fixture(scope="module")
def fractions():
    return []


@pytest.fixture(scope="module")
def report(tmp_path_factory, fractions):
    """Build the whole report once, with a small table of other codes."""
    table = tmp_path_factory.mktemp("peers") / "points.csv"
    table.write_text(PEERS, encoding="utf-8")
    return build(tmp_path_factory.mktemp("report"), fractions.append, peers_table=table)


@pytest.fixture(scope="module")
def browser(tmp_path_factory):
    """Start a headless Chromium with a profile of its own; `make test` installs it on Debian."""
    if not shutil.which("chromedriver"):
        pytest.skip("no chromedriver here: the page is not opened")
    options = webdriver.ChromeOptions()
    options.binary_location = shutil.which("chromium") or shutil.which("google-chrome") or ""
    for flag in FLAGS.split():
        options.add_argument(flag)
    options.add_argument(f"--user-data-dir={tmp_path_factory.mktemp('profile')}")
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    driver = webdriver.Chrome(options, Service(shutil.which("chromedriver")))
    yield driver
    driver.quit()


@pytest.fixture(scope="module")
def page(report, browser):
    """Return the browser with the page open."""
    browser.get(report.page.as_uri())
    return browser


def pixels(png: bytes | Path) -> np.ndarray:
    """Return an image as bytes [row, column, 3]."""
    source = io.BytesIO(png) if isinstance(png, bytes) else png
    return np.asarray(Image.open(source).convert("RGB"))


def ink(image: np.ndarray) -> float:
    """Return the share of pixels that are not nearly white."""
    return float((image.min(axis=2) < 230).mean())


def colours(image: np.ndarray) -> int:
    """Return the number of distinct colours."""
    return len(np.unique(image.astype(np.uint32) @ np.array([1 << 16, 1 << 8, 1], np.uint32)))


def shows(image: np.ndarray, colour: str) -> bool:
    """Return whether a few pixels have a colour, to what blending at a line's edge changes."""
    wanted = 255 * np.array(to_rgb(colour))
    return int((np.abs(image - wanted).max(axis=2) < 30).sum()) >= 5


def curve_ids(report, name: str) -> list[str]:
    """Return the ids of all curves in a figure's SVG file."""
    svg = (report.page.parent / "figures" / f"{name}.svg").read_text(encoding="utf-8")
    return re.findall(rf'id="({name}-\d+-\d+-[a-z-]+)"', svg)


def test_page_opens_without_a_word_on_the_console(page):
    assert page.get_log("browser") == []
    assert "Guo & Li (2002)" in page.title


def test_page_is_no_wider_than_its_window(page):
    width, window = page.execute_script(
        "return [document.documentElement.scrollWidth, window.innerWidth]"
    )
    assert window == 1280
    assert width <= window


def test_first_screen_says_how_far_apart_and_why(page):
    lead = page.find_element(By.CSS_SELECTOR, "p.lead")
    assert lead.rect["y"] + lead.rect["height"] < 500
    assert "17.9 %" in lead.text and "4.0 %" in lead.text and "dispersion" in lead.text
    table = page.find_element(By.CSS_SELECTOR, "table")
    assert table.rect["y"] < 500
    for kind in ("numerical error", "modelling error", "between engines"):
        assert kind in table.text


@pytest.mark.parametrize("name", FIGURES)
def test_figure_is_visible_with_every_curve(report, page, name):
    figure = page.find_element(By.ID, f"{name}-figure")
    assert figure.is_displayed()
    image = pixels(figure.screenshot_as_png)
    assert 0.005 < ink(image) < 0.5
    assert colours(image) > 100
    assert not shows(image, "#ff00ff")
    ids = curve_ids(report, name)
    assert {"dem", "continuum-jointed"} <= {i.split("-", 4)[4] for i in ids}
    boxes = page.execute_script(
        "const o = arguments[0].getBoundingClientRect();"
        "return arguments[1].map(id => {"
        "  const b = document.getElementById(id).getBoundingClientRect();"
        "  return [b.top - o.top, b.bottom - o.top, b.left - o.left, b.right - o.left]; })",
        figure,
        ids,
    )
    for identity, box in zip(ids, boxes, strict=True):
        top, bottom, left, right = (round(SCALE * x) for x in box)
        assert right - left > 500
        crop = image[max(0, top - 4) : bottom + 4, left:right]
        assert shows(crop, style(identity.split("-", 4)[4]).colour), identity


@pytest.mark.parametrize("name", FIGURES)
def test_png_is_not_blank(report, name):
    image = pixels(report.page.parent / "figures" / f"{name}.png")
    assert min(image.shape[:2]) > 400
    assert 0.005 < ink(image) < 0.5


@pytest.mark.parametrize("name", FIGURES)
def test_csv_holds_every_curve_and_only_those(report, name):
    table = pd.read_csv(report.page.parent / "figures" / f"{name}.csv")
    assert table.columns[0] == "time (s)"
    drawn = [identity.split("-", 4)[4] for identity in curve_ids(report, name)]
    written = [column.split(" | ")[0] for column in table.columns[1:]]
    assert sorted(written) == sorted(drawn)
    assert table.columns[1:].str.endswith(("(Pa)", "(m/s)")).all()
    assert not table.isna().any().any()
    scene = cases.load_variant(SCENES / f"{name}.toml")
    assert table["time (s)"].iloc[-1] == pytest.approx(scene.time.duration)


def test_csv_holds_the_load_itself(report):
    """At y = 0 the rigid blocks' stress is the load: 1 MPa times sin(2 pi t / 10 ms)."""
    table = pd.read_csv(report.page.parent / "figures" / "fig-02.csv")
    (column,) = (c for c in table if c.startswith("dem | stress at y = 0 m"))
    one = table[table["time (s)"] < 0.01]
    sine = 1e6 * np.sin(2 * np.pi * one["time (s)"] / 0.01)
    np.testing.assert_allclose(one[column], sine, atol=2e3)  # the mean over a step, half a step off


def test_misfits_are_written_as_numbers(report):
    table = pd.read_csv(report.page.parent / "figures" / "fig-03-misfits.csv")
    chosen = table[(table["pair"] == "dem ~ equivalent-bar") & (table["variant"] == "undamped")]
    assert chosen["relative L2"].item() == pytest.approx(0.179, abs=5e-4)
    assert set(table["kind"]) == {"numerical error", "modelling error", "between engines"}


def test_page_needs_nothing_but_its_own_files(report):
    html = report.page.read_text(encoding="utf-8")
    assert len(html) < 15e6
    assert "<script" not in html
    for link in re.findall(r'(?:href|src)="([^"#][^"]*)"', html):
        assert link == "data:," or (report.page.parent / link).is_file(), link
    for url in re.findall(r"url\((?!#)[^)]*\)|@import[^;]*", html):
        pytest.fail(f"loads {url}")
    ids = re.findall(r'\bid="([^"]+)"', html)
    assert len(ids) == len(set(ids))


def test_the_pillar_in_motion_is_visible(page):
    """A picture of blocks in the colours of compression and of tension, and where to look on."""
    figure = page.find_element(By.ID, "motion-figure")
    assert figure.is_displayed()
    image = pixels(figure.screenshot_as_png)
    assert 0.05 < ink(image) < 0.7
    assert shows(image, "#d6604d") and shows(image, "#4393c3")
    groups = figure.find_elements(By.CSS_SELECTOR, "[id^=snapshots-][id$=-dem]")
    assert len(groups) == 7 and all(group.rect["width"] > 900 for group in groups)
    assert "1350 m/s" in page.find_element(By.ID, "motion").text


def test_the_pillar_in_motion_can_be_opened_in_a_viewer(report):
    found = read_pvd(report.page.parent / "fields" / "dem.pvd")
    assert found.time == pytest.approx(5e-3 * np.arange(8))
    assert found.kind == "hexahedron" and found.displacement[1:].any(axis=(1, 2)).all()


def test_report_leaves_no_half_written_files(report):
    files = [path.name for path in report.page.parent.rglob("*") if path.is_file()]
    motion = ["snapshots.svg", "snapshots.png", "dem.pvd", *(f"{i:04d}.vtu" for i in range(8))]
    points = [len(load(name).points()) for name in REPORTED]
    studies = [f"{name}.{kind}" for name in REPORTED for kind in ("svg", "png", "csv", "nc")]
    drawn = [f"{name}.{kind}" for name in ("peers", "effects") for kind in ("svg", "png", "csv")]
    written = [*motion, *studies, *drawn]
    assert len(files) == 1 + 4 * len(FIGURES) + len(written) + sum(points) + len(reported())
    assert set(written) <= set(files)
    assert not [name for name in files if name.startswith(".")]


@pytest.mark.parametrize("name", REPORTED)
def test_page_shows_what_each_study_found(name, report):
    """Its diagram, and every point of its table."""
    text = html.unescape(report.page.read_text())
    part = text[text.index(f'<section id="{name}">') :]
    part = part[: part.index("</section>")]
    assert "<svg" in part and "Failed points" not in part
    assert all(part.count(curve.label) >= 2 for curve in load(name).curves)


def test_page_shows_other_codes_beside_the_free_pillar(report, page):
    """Ratios, what each solves, the machine, and who is missing and why."""
    part = page.find_element(By.ID, "peers")
    assert "36 (LAMMPS bonds)" in part.text and "a quiet one" in part.text
    assert "Yade spheres (cohesive spheres): missing, no apt here" in part.text
    image = pixels(page.find_element(By.ID, "peers-figure").screenshot_as_png)
    assert 0.005 < ink(image) < 0.5 and shows(image, style("dem").colour)
    text = report.page.read_text()
    order = [text.index(f'<section id="{name}">') for name in ("free-pillar", "peers")]
    assert order == sorted(order) and text.count("<section", *order) == 1


def test_page_shows_what_every_effect_costs_and_is_worth(page):
    """Every scene and effect of the section, in the table and in the diagram."""
    part = page.find_element(By.ID, "effects")
    for case in reported():
        assert case.name in part.text
        assert all(effect in part.text for effect in active_effects(case.scene))
    groups = part.find_elements(By.CSS_SELECTOR, "[id^=effects-points-]")
    assert len(groups) == len({e for case in reported() for e in active_effects(case.scene)})
    assert "jointwave effects" in part.text and "with everything on" in part.text


def test_progress_ends_whole(report, fractions):
    assert fractions == sorted(fractions)
    assert fractions[-1] == 1


def test_summary_has_a_column_a_figure_and_a_row_a_pair(report):
    assert report.columns[:2] == ["what", "pair"]
    assert len(report.columns) == 2 + len(FIGURES)
    pairs = {row[1]: row for row in report.rows}
    assert float(pairs["dem ~ lattice"][3]) < 0.2  # in %, what the default step promises
    assert all(len(row) == len(report.columns) for row in report.rows)


def test_every_figure_has_findings(report):
    assert sorted(report.findings) == list(range(2, 11))
    assert all(report.findings.values())


def test_without_a_table_of_other_codes_one_line_says_how_to_get_it():
    study = StudySection("s", "S", "", "stress", True, "<svg></svg>", [], Table([], {}), [])
    html = render(
        [], {}, overview=None, free=None, summary=Table([], {}), studies=[study], peers_file="a.csv"
    )
    assert "run <code>make bench-peers</code>, then <code>jointwave report" in html
    assert "--peers a.csv</code>" in html


def section(findings: list[Finding]) -> Section:
    empty = Table(["pair"], {})
    return Section("fig-05", 5, "Ends", "source", "toml", "<svg></svg>", findings, *[empty] * 4)


def test_a_failed_claim_is_red_and_named_at_the_top():
    findings = [Finding("waves pass", "They do.", True), Finding("waves stop", "No.", False)]
    html = render([section(findings)], {}, overview=None, free=None, summary=Table([], {}))
    assert '<li class="holds"><strong>waves pass.</strong> They do.</li>' in html
    assert '<li class="fails"><strong>waves stop: does not hold.</strong> No.</li>' in html
    assert "1 of 2 claims do not hold" in html.replace("\n", " ")


def test_a_failed_overview_is_red():
    overview = Finding("claim", "It is not so.", False)
    html = render([], {}, overview=overview, free=Table([], {}), summary=Table([], {}))
    assert '<p class="lead fails">It is not so.</p>' in html


def test_text_of_scenes_is_escaped():
    odd = section([])._replace(title="<b>a & b</b>", toml="x = '<i>'")
    html = render([odd], {}, overview=None, free=None, summary=Table([], {}))
    assert "&lt;b&gt;a &amp; b&lt;/b&gt;" in html and "&lt;i&gt;" in html


def test_what_scenes_share_is_solved_once():
    """Fig. 3 at zeta = 0.02 and fig. 5 with its free end are one simulation."""
    damped = cases.load_variant(SCENES / "fig-03.toml", "zeta 0.02")
    free = cases.load_variant(SCENES / "fig-05.toml")
    assert _key(damped) == _key(free)
    assert _key(damped) != _key(cases.load_variant(SCENES / "fig-03.toml", "zeta 0.05"))


@pytest.mark.parametrize(
    ("name", "names"),
    [
        ("fig-03", ["undamped", "ζ = 0.02", "ζ = 0.05", "ζ = 0.1"]),
        ("fig-05", ["free", "quiet", "matched"]),
        ("fig-07", ["no soft layer", "soft layer"]),
        ("fig-09", ["tension", "no tension"]),
    ],
)
def test_variants_are_named_by_what_differs(name, names):
    comparisons = [Comparison(scene) for scene in cases.load(SCENES / f"{name}.toml")]
    assert variant_names(comparisons) == names


def test_variants_of_other_durations_share_one_table(pillar):
    """Where a shorter variant has no sample the cell is empty."""
    from compare.exact import images

    scenes = [pillar(time__duration=duration, load__cycles=1) for duration in (0.01, 0.02)]
    scenes[1] = scenes[1].model_copy(update={"name": "long"})
    comparisons = [Comparison(scene, {"images": images.solve(scene)}) for scene in scenes]
    table = curve_table(comparisons)
    assert table.shape == (401, 2)
    assert table.isna().sum().tolist() == [200, 0]
