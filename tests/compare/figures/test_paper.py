"""Figures for papers: their width, letters and fonts, and what is drawn in them."""

import re
import xml.etree.ElementTree as ET

import pytest
from matplotlib.image import imread
from matplotlib.text import Text

from jointwave.compare.exact.blocks import row_of_blocks
from jointwave.compare.figures.charts.waveforms import draw_solutions
from jointwave.compare.figures.export import write_drawing
from jointwave.compare.figures.style import printed
from jointwave.compare.misfit.pairs import Comparison

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


def test_the_command_draws_curves_of_others_too(jointwave, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "curve.csv").write_text("time [ms], stress@20 [MPa]\n0, 0\n5, 0.1\n10, 0.2\n")
    options = ["--variant", "", "--engine", "dem", "--set", "time.duration=0.02"]
    said = jointwave("figure", SCENE, *options, "--with", "curve.csv", "--out", "figure.svg")
    assert said == ("wrote figure.svg\n", "")
    drawn = (tmp_path / "figure.svg").read_text()
    assert "curve.csv" in drawn and "rigid blocks" in drawn and "jointed rock" not in drawn
