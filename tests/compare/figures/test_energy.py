"""The picture of energy ledgers against the ledgers themselves."""

from dataclasses import replace

import numpy as np
import pytest

from jointwave.compare.figures.charts.energy import RESIDUAL, energy, ledgers_of
from jointwave.results.dataset import energy_residual


@pytest.fixture(scope="module")
def comparisons(scene_with, compared):
    short = {"time.duration": 0.03}
    scenes = [scene_with(**short, **c) for c in ({}, {"joints.damping_ratio": 0.1})]
    return compared(*scenes, by=("dem",))


@pytest.fixture(scope="module")
def picture(comparisons):
    (found,) = energy("fig", comparisons)
    return found


def test_terms_add_up_to_the_work(picture, comparisons):
    """But for the residual, which is at most that of the ledger, and is in the caption."""
    terms = picture.table.filter(like="(J)").drop(columns="work (J)")
    work, column = picture.table["work (J)"], picture.table[RESIDUAL]
    missing = terms.sum(axis=1) - work
    for (_, rows), comparison in zip(
        picture.table.groupby("variant", sort=False), comparisons, strict=True
    ):
        found = missing[rows.index] / rows["work (J)"].abs().max()
        np.testing.assert_allclose(found, rows[RESIDUAL], atol=1e-15)
        whole = energy_residual(comparison.results["dem"])
        assert 0 < rows[RESIDUAL].abs().max() <= whole < 1e-12
    assert f"rigid blocks {column.abs().max():.1g}." in picture.caption


def test_a_term_that_is_lost_is_seen_as_missing(comparisons):
    result = comparisons[1].results["dem"]
    lost = result.copy(deep=True)
    lost["energy"].loc[{"term": "viscous"}] = 0.0
    ledgers = ledgers_of([comparisons[0], replace(comparisons[1], results={"dem": lost})])
    viscous = result.energy.sel(term="viscous")
    share = float(viscous[-1] / result.energy.sel(term="work").max())
    assert share > 0.01
    assert ledgers[RESIDUAL].iloc[-1] == pytest.approx(-share, rel=1e-9)


def test_curves_hold_the_numbers_of_the_table_and_terms_of_zero_are_not_drawn(picture, ink):
    """The residual has a logarithmic axis of its own."""
    rows = picture.table[picture.table["variant"] == picture.table["variant"].iloc[-1]]
    undamped, upper, _, lower = picture.figure.axes
    found = [line.get_ydata() for line in upper.lines]
    terms = ("kinetic", "elastic", "viscous", "work")
    assert len(found) == len(terms) and len(undamped.lines) == 3
    for term in terms:
        column = rows[f"{term} (J)"].to_numpy()
        assert any(np.allclose(y / np.abs(y).max(), column / np.abs(column).max()) for y in found)
    size = rows[RESIDUAL].abs().to_numpy()
    drawn = np.where(size > 1e-17, size, np.nan)
    np.testing.assert_allclose(lower.lines[0].get_ydata(), drawn, rtol=1e-12)
    np.testing.assert_allclose(upper.lines[0].get_xdata(), 1e3 * rows["time (s)"], atol=1e-6)
    assert (upper.get_yscale(), lower.get_yscale()) == ("linear", "log")
    assert ink(picture.figure) > 0.01


def test_no_ledger_no_picture(pillar, compared):
    scene = pillar(time__duration=0.01, record__energy=False)
    assert energy("fig", compared(scene, by=("dem",))) == []
