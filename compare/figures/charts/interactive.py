"""A chart as an interactive figure, for plotly.js: plain values for JSON.

Subplots are one below the other on one abscissa, so that they zoom together and are readable on a
narrow screen; buttons of the page are their legend. Numbers are base64 of their bytes in single
precision, with as many bits of the mantissa as a screen can show: the rest are zeros, which gzip
compresses away (bit rounding, Kloewer et al. 2021, doi:10.1038/s43588-021-00156-2).
"""

import re
from base64 import b64decode, b64encode
from math import log10
from textwrap import wrap
from typing import Any

import numpy as np

from compare.figures.charts.chart import Chart, ChartLine, Mark, Subplot
from compare.figures.charts.static import MARK
from compare.figures.style import Style

FONT = {"family": "system-ui, 'Segoe UI', Helvetica, Arial, 'DejaVu Sans', sans-serif", "size": 13}
INK, GRID = "#1c2126", "#e3e6e9"
PIXELS = 95  # px per inch of a subplot in print
LINE = 17  # px of a line of a heading
NARROW = 39  # characters of such a line on a phone
TOGETHER = re.compile("(?<==) | (?==|m\\b)")  # spaces of a heading at which no line ends
TOP, BOTTOM, LEFT, RIGHT = 11, 58, 84, 16  # px around the subplots
GAP = 20  # px between subplots, besides their headings
SAMPLES = 800  # of a curve
TICKS = 5  # at most; fewer could leave zero alone on a symmetric axis
BITS = 14  # of the mantissa of a curve's values: a relative error of 3e-5


def packed(values: np.ndarray, bits: int = BITS) -> dict[str, Any]:
    """Return an array as a typed array for plotly.js, with `bits` bits of the mantissa."""
    data = np.asarray(values).astype("<f4")
    lost = 23 - bits
    whole = data.view("<u4").astype(np.uint64) + (1 << (lost - 1))
    rounded = (whole & np.uint64(0xFFFFFFFF ^ ((1 << lost) - 1))).astype("<u4").view("<f4")
    data = np.where(np.isfinite(data), rounded, data)
    shape = {"shape": ",".join(map(str, data.shape))} if data.ndim > 1 else {}
    return {"dtype": "f4", "bdata": b64encode(data.tobytes()).decode("ascii"), **shape}


def unpacked(array: dict[str, Any]) -> np.ndarray:
    """Return the array given to `packed`, with its rounding."""
    values = np.frombuffer(b64decode(array["bdata"]), f"<{array['dtype']}")
    return values.reshape([int(n) for n in array.get("shape", str(values.size)).split(",")])


def places(axis: str, values: np.ndarray) -> dict[str, Any]:
    """Return a trace's coordinates along "x" or "y": first and step if equally spaced, else all."""
    step = (values[-1] - values[0]) / max(1, len(values) - 1)
    even = values[0] + step * np.arange(len(values))
    if len(values) > 1 and np.allclose(values, even, rtol=0, atol=1e-6 * abs(step)):
        return {f"{axis}0": float(f"{values[0]:.9g}"), f"d{axis}": float(f"{step:.9g}")}
    return {axis: packed(values, 22)}


def thinned(samples: int, most: int = SAMPLES) -> slice:
    """Return the slice of samples that are drawn: every k-th, at most `most` and the first."""
    return slice(None, None, max(1, -(-(samples - 1) // most)))


def plot(chart: Chart) -> dict[str, Any]:
    """Return the interactive figure of a chart: {"data": traces, "layout": ...}."""
    abscissa = {"title": {"text": chart.abscissa}} | ({"type": "log"} if chart.is_log else {})
    found = layout(chart.subplots, abscissa)
    entries = [entry for entries in chart.legend.values() for entry in entries]
    rank = {entry.name: i for i, entry in enumerate(entries)}
    lines = [(line, i) for i, subplot in enumerate(chart.subplots) for line in subplot.lines]
    lines.sort(key=lambda one: one[0].style.order)
    for i, subplot in enumerate(chart.subplots):
        found["shapes"] += [_vertical(mark.x, i) for mark in subplot.marks]
        found["annotations"] += [_name(mark, i, chart.is_log) for mark in subplot.marks]
    return {"data": [_trace(line, i, rank[line.name]) for line, i in lines], "layout": found}


def _trace(line: ChartLine, row: int, rank: int) -> dict[str, Any]:
    kept = thinned(len(line.x))
    hovered = {} if line.hovered is None else {"customdata": packed(line.hovered[kept])}
    return {
        "type": "scatter",
        "mode": "lines",
        "name": line.name,
        "legendgroup": line.name,
        "legendrank": rank,
        **places("x", line.x[kept]),
        "y": packed(line.y[kept]),
        **hovered,
        "yaxis": axis_of(row),
        "line": line_style(line.style),
        "hovertemplate": line.hover,
    }


def line_style(style: Style) -> dict[str, Any]:
    """Return a curve's line style, as in print: colour, width, and the dashes with their offset."""
    found: dict[str, Any] = {"color": style.colour, "width": 1.15 * style.width, "simplify": False}
    if style.dashes != "-":
        offset, lengths = style.dashes
        found["dash"] = ",".join(f"{style.width * x:.4g}px" for x in _begun(offset, lengths))
    return found


def _begun(offset: float, lengths: tuple[float, ...]) -> list[float]:
    """Return dash lengths that begin `offset` into their pattern; SVG has no offset here.

    Their number is even, since SVG repeats an odd number with dashes and gaps exchanged: a dash of
    zero length precedes a leading gap, a gap of zero length follows a trailing dash.
    """
    edges = np.cumsum(lengths)
    at = offset % edges[-1]
    first = int(np.searchsorted(edges, at, side="right"))
    rest = [*lengths[first + 1 :], *lengths[:first]]
    left = float(edges[first] - at)
    turned = [left, *rest, lengths[first] - left]
    return [*turned, 0.0] if first % 2 == 0 else [0.0, *turned]


def axis_of(row: int) -> str:
    """Return the name of the y axis of this subplot in a trace."""
    return f"y{row + 1}" if row else "y"


def axis_key(row: int) -> str:
    """Return the key of the y axis of this subplot in the layout."""
    return f"yaxis{row + 1}" if row else "yaxis"


def layout(subplots: list[Subplot], abscissa: dict[str, Any]) -> dict[str, Any]:
    """Return the layout of subplots one below the other on one abscissa."""
    headings = [
        [
            line
            for part in TOGETHER.sub("\u00a0", s.heading).split("\n")
            for line in wrap(part, NARROW)
        ]
        for s in subplots
    ]
    above = [LINE * max(1, len(lines)) for lines in headings]
    heights = [round(PIXELS * s.height) for s in subplots]
    inner = sum(heights) + sum(above[1:]) + GAP * (len(subplots) - 1)
    axes: dict[str, Any] = {}
    notes, top, shared = [], float(inner), dict[str, str]()
    for i, (subplot, height) in enumerate(zip(subplots, heights, strict=True)):
        domain = [max(0.0, (top - height) / inner), top / inner]
        axes[axis_key(i)] = _axis(subplot.label) | {"domain": domain} | _ordinate(subplot)
        if subplot.share and (first := shared.setdefault(subplot.share, axis_of(i))) != axis_of(i):
            axes[axis_key(i)]["matches"] = first
        notes.append(_heading("<br>".join(headings[i]), domain[1]))
        top -= height + GAP + (above[i + 1] if i + 1 < len(above) else 0)
    return {
        "template": {"layout": {}},
        "paper_bgcolor": "#ffffff",
        "plot_bgcolor": "#ffffff",
        "font": FONT | {"color": INK},
        "height": TOP + above[0] + inner + BOTTOM,
        "margin": {"t": TOP + above[0], "b": BOTTOM, "l": LEFT, "r": RIGHT},
        "hovermode": "closest",
        "showlegend": False,
        "annotations": notes,
        "shapes": [],
        "xaxis": _axis("") | {"anchor": axis_of(len(subplots) - 1)} | abscissa,
        **axes,
    }


def _axis(label: str) -> dict[str, Any]:
    return {
        "title": {"text": label.replace("\n", "<br>"), "font": {"size": FONT["size"]}},
        "showline": True,
        "linecolor": "#8a9299",
        "gridcolor": GRID,
        "zerolinecolor": "#b6bcc2",
        "ticks": "outside",
        "tickcolor": "#8a9299",
        "automargin": False,
    }


def _ordinate(subplot: Subplot) -> dict[str, Any]:
    few = 4 if subplot.is_log else TICKS
    found: dict[str, Any] = {"nticks": few} if subplot.is_minor else {}
    if subplot.is_log:
        found |= {"type": "log", "exponentformat": "power"}
        if subplot.limits:
            found |= {"range": [log10(value) for value in subplot.limits], "dtick": 1}
    if subplot.ticks:
        found["tickvals"] = subplot.ticks
    return found


def _heading(text: str, top: float) -> dict[str, Any]:
    return {
        "text": text,
        "xref": "paper",
        "yref": "paper",
        "x": 0,
        "y": top,
        "xanchor": "left",
        "yanchor": "bottom",
        "align": "left",
        "showarrow": False,
        "font": {"size": 13},
    }


def _vertical(x: float, row: int) -> dict[str, Any]:
    return {
        "type": "line",
        "yref": f"{axis_of(row)} domain",
        "x0": x,
        "x1": x,
        "y0": 0,
        "y1": 1,
        "layer": "below",
        "line": {"color": MARK, "width": 1, "dash": "1px,3px"},
    }


def _name(mark: Mark, row: int, is_log: bool) -> dict[str, Any]:
    return {
        "text": mark.name,
        "x": log10(mark.x) if is_log else mark.x,
        "xanchor": "right" if mark.is_left else "left",
        "yref": f"{axis_of(row)} domain",
        "y": 0.98 if mark.is_high else 0.02,
        "yanchor": "top" if mark.is_high else "bottom",
        "textangle": -90,
        "showarrow": False,
        "font": {"size": 11, "color": MARK},
    }
