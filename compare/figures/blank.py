"""A figure that is drawn without any window: in the style of all, laid out by matplotlib."""

from collections.abc import Iterator
from contextlib import contextmanager

import matplotlib
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from compare.figures.style import RC, WIDTH


@contextmanager
def blank(height: float, width: float = WIDTH, laid_out: bool = False) -> Iterator[Figure]:
    """Give an empty figure to be drawn on, inches; constraints lay it out once that is done, unless
    the drawing lays it out itself."""
    with matplotlib.rc_context(RC):
        figure = Figure(figsize=(width, height))
        FigureCanvasAgg(figure)
        yield figure
        if not laid_out:
            figure.set_layout_engine("constrained")
