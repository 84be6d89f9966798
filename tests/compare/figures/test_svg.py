"""Compact SVGs: drawn parts keep their positions."""

import base64
import io
import re
from xml.etree import ElementTree

import numpy as np
import pytest
from matplotlib.figure import Figure
from PIL import Image

from compare.figures.export import compact

HEAD = '<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink">'


def points(path):
    """Return the points of a path of one relative move and lines, whose letters are left out."""
    assert re.fullmatch(r"m[-. \d]+", path)
    steps = [float(step) for step in re.findall(r"-?(?:\d+\.?\d*|\.\d+)", path)]
    return np.cumsum(np.reshape(steps, (-1, 2)), axis=0)


def test_points_of_a_path_stay_within_half_a_hundredth():
    """The steps add up to rounded places, not rounded steps to an error that grows."""
    place = 400 + 300 * np.random.default_rng(3).standard_normal((500, 2))
    path = "\n".join(f"{'L' if i else 'M'} {x:.6f} {y:.6f} " for i, (x, y) in enumerate(place))
    small = compact(f'{HEAD}<path d="{path}"/></svg>', "a")
    found = points(re.search(r' d="([^"]*)"', small)[1])
    np.testing.assert_allclose(found, place, atol=0.0051)
    assert len(small) < 0.65 * len(path)


def test_lines_after_a_move_have_no_letter_and_each_move_has_its_own():
    path = "M 1 2 L 1.5 1 L 1 1.25 M 0 0 L -0.5 0 z"
    small = compact(f'{HEAD}<path d="{path}"/></svg>', "a")
    assert ' d="m1 2 .5-1-.5 .25m-1-1.25-.5 0z"' in small


def test_uses_do_not_repeat_the_stroke_of_their_path():
    """A path's stroke overrides that of its use; its fill is that of the use."""
    path = '<path id="m1" d="M 0 0" style="stroke: #000; stroke-width: 0.6"/>'
    use = '<use xlink:href="#m1" x="1" style="stroke: #000; stroke-width: 0.6{}"/>'
    small = compact(f"{HEAD}{path}{use.format('')}{use.format('; fill: #fff')}</svg>", "a")
    assert re.findall(r"<use[^>]*/>", small) == [
        '<use xlink:href="#a-m1" x="1"/>',
        '<use xlink:href="#a-m1" x="1" style="fill: #fff"/>',
    ]


def test_groups_that_matplotlib_counts_are_gone_and_named_ones_stay():
    counted = '<g id="xtick_1">\n<g id="line2d_2">\n<path d="M 0 0"/>\n</g>\n</g>\n'
    drawn = f'{counted}<g id="curve-0">\n</g>\n'
    small = compact(f"{HEAD}\n{drawn}</svg>", "a")
    assert re.findall(r"<g[^>]*>", small) == ['<g id="a-curve-0">'] and small.count("<path") == 1


@pytest.mark.parametrize("path", ["M 0 0 C 1 1 2 2 3 3 ", "M 0 0 Q 1 1 2 0 z"])
def test_curves_keep_their_letters(path):
    small = compact(f'{HEAD}<path d="{path}"/></svg>', "a")
    assert f' d="{path}"' in small


def test_text_keeps_its_decimals():
    """Of coordinates two are left; the number at a tick is none of them."""
    small = compact(f'{HEAD}<text x="1.23456">0.0255</text></svg>', "a")
    assert '<text x="1.23">0.0255</text>' in small


def test_ids_are_scoped_and_their_uses_follow():
    svg = f'{HEAD}<path id="m1" d="M 0 0"/><g id="xtick_1"><use xlink:href="#m1"/></g></svg>'
    small = compact(svg, "fig")
    assert 'id="fig-m1"' in small and 'href="#fig-m1"' in small


def test_no_id_is_there_twice():
    """As those of an image that is drawn twice."""
    twice = '<image id="image1" href="data:,"/><g id="part"/>' * 2
    small = compact(f"{HEAD}{twice}</svg>", "fig")
    assert re.findall(r'id="([^"]+)"', small) == ["fig-image1", "fig-part"]
    assert small.count("<image") == 2


def test_a_figure_of_matplotlib_stays_whole():
    figure = Figure()
    ax = figure.subplots()
    ax.plot([0, 1, 2], [0, 4, 1], "o-")
    ax.imshow(np.arange(12.0).reshape(3, 4), extent=(0, 2, 0, 4), aspect="auto")
    buffer = io.StringIO()
    figure.savefig(buffer, format="svg")
    small = compact(buffer.getvalue(), "whole")
    before, after = (ElementTree.fromstring(text) for text in (buffer.getvalue(), small))
    for tag in ("path", "use", "image", "text"):
        name = f"{{http://www.w3.org/2000/svg}}{tag}"
        assert len(list(after.iter(name))) == len(list(before.iter(name)))


@pytest.mark.parametrize("colours", [2, 200, 5000])
def test_colours_of_an_image_stay(colours):
    """With a palette where they fit into one, and as they are where not."""
    pixels = np.random.default_rng(1).integers(0, colours, (90, 90))
    shown = np.stack([pixels % 251, pixels // 251, 0 * pixels], axis=2).astype(np.uint8)
    buffer = io.BytesIO()
    Image.fromarray(shown).save(buffer, "PNG")
    png = base64.b64encode(buffer.getvalue()).decode()
    small = compact(f'{HEAD}<image xlink:href="data:image/png;base64,{png}"/></svg>', "a")
    found = Image.open(io.BytesIO(base64.b64decode(re.search(r'base64,([^"]+)', small)[1])))
    assert (np.asarray(found.convert("RGB")) == shown).all()
    assert (found.mode == "P") == (colours <= 256)
