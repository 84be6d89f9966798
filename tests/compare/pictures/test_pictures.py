"""All pictures of a scene together."""

import json

import numpy as np
import pytest
from matplotlib.colors import to_hex

from compare.aligned import lay_beside
from compare.curves import Curves, Place
from compare.engines import solve
from compare.pictures import KINDS, pictures_of
from compare.pictures.along import recorded_along
from compare.pictures.interactive import unpacked
from compare.pictures.waveforms import waveforms
from compare.style import GIVEN


@pytest.fixture
def comparisons(pillar, compared):
    scenes = [pillar(time__duration=0.03, **c) for c in ({}, {"joints__damping_ratio": 0.05})]
    return compared(*scenes)


@pytest.fixture
def pictures(comparisons):
    wide = recorded_along(comparisons[0].scene)
    return pictures_of("fig", comparisons, {name: solve(name, wide) for name in ("dem", "lattice")})


def test_kinds_come_in_the_order_of_the_page_each_under_its_own_name(pictures):
    assert [p.kind for p in pictures] == list(KINDS)
    names = [p.name for p in pictures]
    assert len(set(names)) == len(names) and all(n.startswith("fig-") for n in names)


def test_no_picture_is_blank(pictures, ink):
    for picture in pictures:
        assert 0.005 < ink(picture.static) < 0.6, picture.name
        assert len(picture.table) > 0 and picture.title and picture.caption


def test_interactive_figures_are_plain_values_without_titles_of_their_own(pictures):
    for picture in pictures:
        if picture.plot is not None:
            assert json.loads(json.dumps(picture.plot, allow_nan=False)) == picture.plot
            assert "title" not in picture.plot["layout"]
            assert all("hovertemplate" in trace for trace in picture.plot["data"])
    assert [p.kind for p in pictures if p.plot is None] == ["scene"]


def test_tables_carry_units(pictures):
    bare = {"variant", "part", "what", "engine"}
    for picture in pictures:
        assert all(c in bare or c.endswith(")") for c in picture.table.columns), picture.name


def test_without_fields_there_are_no_diagrams(comparisons):
    assert "space-time" not in [p.kind for p in pictures_of("fig", comparisons, {})]


def test_waveforms_hold_the_numbers_of_the_table(pictures, values):
    picture = next(p for p in pictures if p.kind == "waveforms")
    columns = iter(picture.table.columns[1:])
    by_axis = sorted(picture.plot["data"], key=lambda t: (t["yaxis"], t["name"] != "dem"))
    for trace, column in zip(by_axis, columns, strict=True):
        assert column.startswith(f"{trace['name']} | ")
        y, x = unpacked(trace["y"]), values(trace, "x")
        at = np.searchsorted(picture.table["time (s)"], 1e-3 * x - 1e-9)
        np.testing.assert_allclose(
            y, 1e-6 * picture.table[column].values[at], rtol=1e-6, atol=1e-30
        )
        assert len(y) == len(picture.table)


def test_waveforms_have_the_colours_of_print(pictures):
    picture = next(p for p in pictures if p.kind == "waveforms")
    printed = {
        line.get_gid().split("-", 4)[4]: to_hex(line.get_color())
        for ax in picture.static.axes
        for line in ax.lines
        if line.get_gid()
    }
    drawn = {trace["name"]: trace["line"]["color"] for trace in picture.plot["data"]}
    assert drawn == printed and set(drawn) == {"dem", "lattice"}


def test_a_legend_entry_switches_a_solution_in_every_panel(pictures):
    picture = next(p for p in pictures if p.kind == "waveforms")
    for name in ("dem", "lattice"):
        traces = [t for t in picture.plot["data"] if t["legendgroup"] == name]
        assert len(traces) == 2 and [t["showlegend"] for t in traces].count(True) == 1


def test_curves_of_others_stand_beside_at_their_own_times(pillar, compared):
    (comparison,) = compared(pillar(time__duration=0.03))
    time = np.array([0.0, 0.011, 0.017, 0.029])
    place = Place("stress", "", 20.0)
    given = Curves("lab.csv", "lab.csv", time, {place: np.array([0.0, 1e5, 8e5, -2e5])})
    comparison.besides.append(lay_beside(given, comparison.scene, comparison.results, False))
    (trace,) = [t for t in waveforms("fig", [comparison]).plot["data"] if t["name"] == "lab.csv"]
    np.testing.assert_allclose(unpacked(trace["x"]), 1e3 * time, rtol=1e-6)
    np.testing.assert_allclose(unpacked(trace["y"]), [0.0, 0.1, 0.8, -0.2], rtol=1e-6)
    assert trace["line"]["color"] == GIVEN[0].colour and trace["showlegend"]
