"""The picture of energy ledgers against the ledgers themselves."""

from dataclasses import replace

import numpy as np
import pytest

from compare.figures.charts.energy import energy, ledgers_of
from compare.figures.charts.interactive import BITS, unpacked
from compare.figures.units import unit_for
from results.dataset import energy_residual

ROUNDED = 2.0**-BITS  # of a number that is drawn on the screen


@pytest.fixture(scope="module")
def comparisons(scene_with, compared):
    short = {"time.duration": 0.03}
    scenes = [scene_with(**short, **c) for c in ({}, {"joints.damping_ratio": 0.1})]
    return compared(*scenes, by=("dem",))


@pytest.fixture(scope="module")
def picture(comparisons):
    (found,) = energy("fig", comparisons)
    return found


def test_terms_add_up_to_the_work(picture):
    terms = [c for c in picture.table.columns if c.endswith("(J)")]
    others = picture.table[[c for c in terms if c != "work (J)"]].sum(axis=1)
    work = picture.table["work (J)"]
    for variant, rows in picture.table.groupby("variant"):
        scale = rows["work (J)"].abs().max()
        missing = (others - work)[rows.index] / scale
        column = rows["residual (of the largest work)"]
        np.testing.assert_allclose(missing, column, atol=1e-15, err_msg=variant)
        assert missing.abs().max() < 1e-12


def test_residual_is_that_of_the_ledger(comparisons):
    for ledger, comparison in zip(ledgers_of(comparisons), comparisons, strict=True):
        whole = energy_residual(comparison.results["dem"])
        assert 0 < np.abs(ledger.residual).max() <= whole


def test_a_term_that_is_lost_is_seen_as_missing(comparisons):
    result = comparisons[1].results["dem"]
    lost = result.copy(deep=True)
    lost["energy"].loc[{"term": "viscous"}] = 0.0
    changed = replace(comparisons[1], results={"dem": lost})
    ledger = ledgers_of([comparisons[0], changed])[1]
    viscous = result.energy.sel(term="viscous")
    share = float(viscous[-1] / result.energy.sel(term="work").max())
    assert share > 0.01
    assert ledger.residual[-1] == pytest.approx(-share, rel=1e-9)


def test_terms_that_are_zero_are_not_drawn(picture):
    drawn = {
        variant: {t["name"] for t in picture.plot["data"] if t["yaxis"] == axis}
        for variant, axis in (("undamped", "y"), ("damped", "y3"))
    }
    assert drawn["undamped"] == {"kinetic", "elastic", "work"}
    assert drawn["damped"] == {"kinetic", "elastic", "viscous", "work"}


def test_traces_hold_the_numbers_of_the_table(picture, values):
    variants = picture.table["variant"].unique()
    unit = unit_for("J", picture.table["work (J)"].max())
    assert len(picture.plot["data"]) == 3 + 4 + 2
    for trace in picture.plot["data"]:
        row = int(trace["yaxis"].removeprefix("y") or 1) - 1
        rows = picture.table[picture.table["variant"] == variants[row // 2]]
        np.testing.assert_allclose(values(trace, "x"), 1e3 * rows["time (s)"], atol=1e-6)
        drawn = unpacked(trace["y"])
        if row % 2:
            size = rows["residual (of the largest work)"].abs().values
            np.testing.assert_allclose(drawn, np.where(size > 1e-17, size, np.nan), rtol=ROUNDED)
        else:
            column = rows[f"{trace['name']} (J)"] / unit.size
            np.testing.assert_allclose(drawn, column, rtol=ROUNDED, atol=1e-30)


def test_missing_has_an_axis_of_its_own(picture, ink):
    layout = picture.plot["layout"]
    assert layout["yaxis2"]["type"] == layout["yaxis4"]["type"] == "log"
    assert "type" not in layout["yaxis"]
    upper, lower = picture.static.axes[:2], picture.static.axes[2:]
    assert all(ax.get_yscale() == "linear" for ax in upper)
    assert all(ax.get_yscale() == "log" for ax in lower)
    assert ink(picture.static) > 0.01


def test_caption_says_the_largest_that_is_missing(picture, comparisons):
    worst = max(np.abs(ledger.residual).max() for ledger in ledgers_of(comparisons))
    assert f"dem {worst:.1g}." in picture.caption


def test_no_ledger_no_picture(pillar, compared):
    scene = pillar(time__duration=0.01, record__energy=False)
    assert energy("fig", compared(scene, by=("dem",))) == []
