"""Parts of interactive figures, as plotly.js takes them: arrays, axes of stacked panels, lines.

Panels stand one under the other on one time axis, so that they zoom together and stay readable on
a narrow screen; the legend is below them. Numbers are packed as base64 of their bytes.
"""

from base64 import b64decode, b64encode
from textwrap import wrap
from typing import Any, NamedTuple

import numpy as np

from compare.figures.style import Style

FONT = {"family": "system-ui, 'Segoe UI', Helvetica, Arial, 'DejaVu Sans', sans-serif", "size": 13}
INK, GRID = "#1c2126", "#e3e6e9"
LINE = 17  # px of a line of a heading
NARROW = 42  # characters of such a line that a phone has room for
TOP, BOTTOM, LEFT, RIGHT = 11, 58, 66, 16  # px around the panels
GAP = 20  # px between panels, besides their headings
ENTRY = 20  # px of a line of the legend
ITEM = 40  # px of the sample of a curve in the legend


class Panel(NamedTuple):
    """One of the stacked panels: its heading, the label of its y axis, its height in px, and more
    keys of that axis."""

    heading: str
    label: str
    height: int = 190
    axis: dict[str, Any] | None = None


def packed(values: np.ndarray) -> dict[str, Any]:
    """Return an array as plotly.js reads typed arrays, in single precision."""
    data = np.asarray(values).astype("<f4")
    found = {"dtype": "f4", "bdata": b64encode(data.tobytes()).decode("ascii")}
    if data.ndim > 1:
        found["shape"] = ",".join(map(str, data.shape))
    return found


def unpacked(array: dict[str, Any]) -> np.ndarray:
    """Return the array that `packed` was given, as rounded as it is kept."""
    values = np.frombuffer(b64decode(array["bdata"]), f"<{array['dtype']}")
    return values.reshape([int(n) for n in array.get("shape", str(values.size)).split(",")])


def places(axis: str, values: np.ndarray) -> dict[str, Any]:
    """Return a trace's places along "x" or "y": first and step where they are even, else all."""
    step = (values[-1] - values[0]) / max(1, len(values) - 1)
    even = values[0] + step * np.arange(len(values))
    if len(values) > 1 and np.allclose(values, even, rtol=0, atol=1e-6 * abs(step)):
        return {f"{axis}0": float(f"{values[0]:.9g}"), f"d{axis}": float(f"{step:.9g}")}
    return {axis: packed(values)}


def line(look: Style) -> dict[str, Any]:
    """Return how a curve is drawn, as in print: colour, width, and the dashes with their offset."""
    found: dict[str, Any] = {"color": look.colour, "width": 1.15 * look.width, "simplify": False}
    if look.dashes != "-":
        offset, lengths = look.dashes
        found["dash"] = ",".join(f"{look.width * x:.4g}px" for x in _begun(offset, lengths))
    return found


def _begun(offset: float, lengths: tuple[float, ...]) -> list[float]:
    """Return dash lengths that begin `offset` into their pattern; SVG has no offset here.

    An even number of them, as SVG repeats an odd one with dashes and gaps exchanged: a dash of no
    length is put before a gap that comes first, a gap of none after a dash that comes last.
    """
    edges = np.cumsum(lengths)
    at = offset % edges[-1]
    first = int(np.searchsorted(edges, at, side="right"))
    rest = [*lengths[first + 1 :], *lengths[:first]]
    left = float(edges[first] - at)
    turned = [left, *rest, lengths[first] - left]
    return [*turned, 0.0] if first % 2 == 0 else [0.0, *turned]


def axis_of(panel: int) -> str:
    """Return what a trace calls the y axis of the panel with this number."""
    return f"y{panel + 1}" if panel else "y"


def axis_key(panel: int) -> str:
    """Return what the layout calls it."""
    return f"yaxis{panel + 1}" if panel else "yaxis"


def thinned(samples: int, most: int) -> slice:
    """Return which of so many samples are drawn: every k-th, at most `most` and the first."""
    return slice(None, None, max(1, -(-(samples - 1) // most)))


def layout(panels: list[Panel], x: dict[str, Any], entries: int) -> dict[str, Any]:
    """Return the layout of panels under each other on one x axis, `entries` in the legend."""
    # Two lines of the legend on a wide screen; on a narrow one it takes its room from the panels.
    legend = ENTRY * (1 + (entries > 5)) if entries else 0
    headings = [
        [line for part in panel.heading.split("\n") for line in wrap(part, NARROW)]
        for panel in panels
    ]
    rooms = [LINE * max(1, len(lines)) for lines in headings]
    inner = sum(p.height for p in panels) + sum(rooms[1:]) + GAP * (len(panels) - 1)
    axes: dict[str, Any] = {}
    notes, top = [], float(inner)
    for i, panel in enumerate(panels):
        domain = [max(0.0, (top - panel.height) / inner), top / inner]
        axis = _axis(panel.label) | {"domain": domain} | (panel.axis or {})
        axes[axis_key(i)] = axis
        notes.append(_heading("<br>".join(headings[i]), domain[1]))
        top -= panel.height + GAP + (rooms[i + 1] if i + 1 < len(rooms) else 0)
    return {
        "template": {"layout": {}},
        "paper_bgcolor": "#ffffff",
        "plot_bgcolor": "#ffffff",
        "font": FONT | {"color": INK},
        "height": TOP + rooms[0] + inner + BOTTOM + legend,
        "margin": {"t": TOP + rooms[0], "b": BOTTOM + legend, "l": LEFT, "r": RIGHT},
        "hovermode": "closest",
        "showlegend": bool(entries),
        "legend": _legend(inner),
        "annotations": notes,
        "xaxis": _axis("") | {"anchor": axis_of(len(panels) - 1)} | x,
        **axes,
    }


def _axis(label: str) -> dict[str, Any]:
    return {
        "title": {"text": label},
        "showline": True,
        "linecolor": "#8a9299",
        "gridcolor": GRID,
        "zerolinecolor": "#b6bcc2",
        "ticks": "outside",
        "tickcolor": "#8a9299",
        "automargin": False,
    }


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


def _legend(inner: int) -> dict[str, Any]:
    return {
        "orientation": "h",
        "x": 0,
        "xanchor": "left",
        "y": -(BOTTOM + 8) / inner,
        "yanchor": "top",
        "font": {"size": 12},
        "itemwidth": ITEM,
        "tracegroupgap": 0,
    }


def in_layers(traces: list[dict[str, Any]], looks: dict[str, Style]) -> list[dict[str, Any]]:
    """Return traces in the order that they are drawn over each other, one legend entry a group.

    looks : by group, in the order of the legend.
    """
    rank = {group: i for i, group in enumerate(looks)}
    found, listed = [], set()
    for trace in sorted(traces, key=lambda t: looks[t["legendgroup"]].order):
        group = trace["legendgroup"]
        found.append(trace | {"legendrank": rank[group], "showlegend": group not in listed})
        listed.add(group)
    return found
