"""Figures for papers: their width, letters and fonts, and what is drawn in them."""

import re
import xml.etree.ElementTree as ET

import numpy as np
import pytest
from matplotlib.image import imread
from matplotlib.text import Text

from jointwave.compare.exact.blocks import row_of_blocks
from jointwave.compare.figures.charts.waveforms import draw_solutions
from jointwave.compare.figures.export import write_drawing
from jointwave.compare.figures.style import printed
from jointwave.compare.misfit.pairs import Comparison
from jointwave.compare.misfit.ranking import applicable
from jointwave.compare.runs.comparison import solved

SCENE = "guo-li-2002/fig-03"
SHORT = {"time__duration": 0.01, "record__velocity": [20.25]}


@pytest.fixture
def drawn(pillar):
    """Return a function that draws variants, solved by the exact chain, at a width (mm)."""

    def draw(width, name="damped"):
        scenes = [pillar(**SHORT), pillar(**SHORT, joints__damping_ratio=0.05)]
        scenes[1] = scenes[1].model_copy(update={"name": name})
        found = [
            Comparison(scene, dict.fromkeys(("lattice", "dem"), row_of_blocks.solve(scene)))
            for scene in scenes
        ]
        return draw_solutions(found, False, printed(width, 8.0))

    return draw


@pytest.mark.parametrize("width", [90.0, 190.0])
def test_the_page_is_as_wide_as_asked_and_needs_no_font(drawn, tmp_path, width):
    """To 0.1 mm, in every format, and the same figure is the same file. A PDF holds its fonts as
    TrueType, an SVG has outlines."""
    rc, names = printed(width, 8.0), ("a.pdf", "a.svg", "a.png", "b.pdf", "b.svg", "b.png")
    files = [write_drawing(tmp_path / name, drawn(width), "A title", rc) for name in names]
    pdf, svg, png = files[:3]
    content, tree = pdf.read_bytes(), ET.parse(svg).getroot()
    box = re.search(rb"/MediaBox \[ 0 0 ([\d.]+) [\d.]+ \]", content)
    points = tree.get("width").removesuffix("pt")
    widths = float(box[1]) / 72, float(points) / 72, imread(png).shape[1] / 600
    assert [25.4 * inches for inches in widths] == pytest.approx(3 * [width], abs=0.1)
    assert [file.read_bytes() for file in files[:3]] == [file.read_bytes() for file in files[3:]]
    assert content.count(b"/FontFile2") == content.count(b"/Type /FontDescriptor") > 0
    assert b"/Type3" not in content
    assert not list(tree.iter("{http://www.w3.org/2000/svg}text"))


@pytest.mark.parametrize("width", [90.0, 190.0])
@pytest.mark.parametrize("name", ["damped", "the same joints after a cycle of loading, damped"])
def test_nothing_is_cut_off_or_overprinted(drawn, collisions, width, name):
    figure = drawn(width, name)
    assert collisions(figure) == []
    across = {round(ax.get_position().x0, 2) for ax in figure.axes}
    assert len(figure.axes) == 4 and len(across) == (1 if width == 90 else 2)
    sizes = {t.get_fontsize() for t in figure.findobj(Text) if t.get_text().strip()}
    assert sizes == {8.0}


def test_what_is_asked_for_is_drawn(pillar):
    """By engines and models, and every curve is that of its solution."""
    scene, done = pillar(**SHORT), []
    asked = {name: applicable(scene)[name] for name in ("dem", "lattice")}
    figure = draw_solutions([solved(scene, asked, done.append)], False, printed(190.0, 8.0))
    lines = {line.get_label(): line for line in figure.axes[0].lines}
    assert {"rigid blocks", "rigid blocks, exact"} < set(lines)
    assert not any("jointed" in label for label in lines)
    assert done == sorted(done) and 0.5 in done and done[-1] == 1.0
    exact = 1e-6 * row_of_blocks.solve(scene).stress.values[0]
    np.testing.assert_allclose(lines["rigid blocks, exact"].get_ydata(), exact)


@pytest.mark.parametrize(
    "arguments, words",
    [
        (("--out", "figure.doc"), "must end in .pdf or .svg or .png"),
        (("--out", "figure.pdf", "--width", "3"), "width"),
        (("--out", "figure.pdf", "--engine", "exact", "--model", "no-tension-chain"), "tension"),
        (("--out", "taken.pdf", "--variant", "", "--engine", "dem"), "would be overwritten"),
        ((), "--out"),
    ],
)
def test_a_mistake_is_one_line(jointwave, tmp_path, monkeypatch, arguments, words):
    """And no file is written or lost."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "taken.pdf").write_text("mine")
    said = jointwave("figure", SCENE, *arguments, code=2).err
    assert said.count("\n") == 1 and words in said
    assert [path.name for path in tmp_path.iterdir()] == ["taken.pdf"]
    assert (tmp_path / "taken.pdf").read_text() == "mine"


def test_the_command_draws_curves_of_others_too(jointwave, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "curve.csv").write_text("time [ms], stress@20 [MPa]\n0, 0\n5, 0.1\n10, 0.2\n")
    options = ["--variant", "", "--engine", "dem", "--set", "time.duration=0.02"]
    said = jointwave("figure", SCENE, *options, "--with", "curve.csv", "--out", "figure.svg")
    assert said == ("wrote figure.svg\n", "")
    assert "curve.csv" in (tmp_path / "figure.svg").read_text()
