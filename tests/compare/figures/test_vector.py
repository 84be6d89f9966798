"""Drawings made together: the SVG is matplotlib's own, and so is the PDF but for a point."""

import io
from collections import defaultdict

import matplotlib
import numpy as np
import pytest
from matplotlib.figure import Figure
from pdfminer.high_level import extract_pages
from pdfminer.layout import LTChar, LTContainer, LTCurve, LTImage

from compare.figures.style import RC
from compare.figures.vector import draw_both

ABOUT = {"Title": "a figure"}
MOST = 1.0  # points that a formula may stand elsewhere, as wide as the SVG has it


@pytest.fixture
def figure():
    """Return a figure with text, formulas, curves, an image and a part drawn as pixels."""
    with matplotlib.rc_context(RC | {"svg.hashsalt": "a"}):
        drawn = Figure(figsize=(6, 4))
        (left, right), values = drawn.subplots(1, 2), np.linspace(0, 1, 20)
        left.loglog(values + 0.01, values + 0.02, "o-", label="a curve")
        left.set(xlabel="time (s)", ylabel="energy (J)")
        left.legend()
        right.imshow(np.outer(values, values), extent=(0, 1, 0, 1), cmap="RdBu_r")
        right.plot(values, values**2, rasterized=True)
        right.fill_between(values, values, hatch="/")
        right.annotate("up", (0.5, 0.5), rotation=90)
        yield drawn


def parts(pdf):
    """Return the places of the letters, paths and images of a PDF, by what they look like."""
    found = defaultdict(list)

    def visit(page):
        for one in page:
            if isinstance(one, LTChar):
                found[one.get_text(), one.fontname.partition("+")[2]].append(one.bbox)
            elif isinstance(one, LTCurve | LTImage):
                style = [str(getattr(one, k, "")) for k in ("linewidth", "stroking_color")]
                found[type(one).__name__, *style].append(one.bbox)
            elif isinstance(one, LTContainer):
                visit(one)

    for page in extract_pages(io.BytesIO(pdf), laparams=None):
        visit(page)
    return {kind: np.array(places) for kind, places in found.items()}


def test_both_drawings_are_those_that_matplotlib_makes_one_by_one(figure):
    found, svg, pdf = draw_both(figure, ABOUT["Title"]), io.StringIO(), io.BytesIO()
    figure.savefig(svg, format="svg", metadata=ABOUT | {"Date": None})
    figure.savefig(pdf, format="pdf", metadata=ABOUT | {"CreationDate": None})
    assert found.svg == svg.getvalue()
    own, expected = parts(found.pdf), parts(pdf.getvalue())
    assert {"LTImage", "LTCurve"} <= {kind[0] for kind in own} and own.keys() == expected.keys()
    for kind, places in own.items():
        apart = np.abs(places[:, None] - expected[kind]).max(axis=-1)
        assert len(places) == len(expected[kind]), kind
        assert max(apart.min(axis=0).max(), apart.min(axis=1).max()) < MOST, kind


def test_neither_drawing_has_a_date(figure):
    one, other = draw_both(figure, "a"), draw_both(figure, "a")
    assert one == other and b"CreationDate" not in one.pdf and "<dc:date>" not in one.svg
