"""All pictures of a scene together, and that of its energy ledgers against these."""

from dataclasses import replace

import numpy as np
import pytest

from jointwave.compare.engines import solve
from jointwave.compare.figures.charts.energy import RESIDUAL, energy, ledgers_of
from jointwave.compare.figures.scene_figures import figures_of, recorded_along
from jointwave.results.dataset import energy_residual


@pytest.fixture(scope="module")
def comparisons(pillar, compared):
    short = {"time.duration": 0.03}
    scenes = [pillar(**short, **c) for c in ({}, {"joints.damping_ratio": 0.05})]
    return compared(scenes[0], scenes[1].model_copy(update={"name": "damped"}))


@pytest.fixture(scope="module")
def pictures(comparisons):
    fields = [
        {name: solve(name, recorded_along(c.scene)) for name in ("dem", "lattice")}
        for c in comparisons
    ]
    found = figures_of("fig", comparisons, fields)
    return {one.name.removeprefix("fig-"): one for one in found}


def test_pictures_come_in_the_order_of_the_page_each_under_its_own_name(pictures):
    assert list(pictures) == [
        *("scene", "variants", "waveforms", "space-time-0", "space-time-0-exact"),
        *("space-time-1", "space-time-1-exact", "spectra", "energy"),
    ]
    shown = [p.title for name, p in pictures.items() if "space-time" in name and not p.folded]
    assert shown == ["Stress along the pillar over time, undamped"]


def test_no_picture_is_blank_and_tables_carry_units(pictures, ink):
    bare = {"variant", "part", "what", "engine"}
    for name, picture in pictures.items():
        assert 0.005 < ink(picture.figure) < 0.6, name
        assert len(picture.table) > 0 and picture.title and picture.caption
        assert all(c in bare or c.endswith(")") for c in picture.table.columns), name


def test_variants_stand_in_one_pair_of_axes_and_every_solution_in_a_fold(pictures):
    first, second = pictures["variants"], pictures["waveforms"]
    assert (first.folded, second.folded) == (False, True)
    upper, lower = first.figure.axes
    assert upper.get_title(loc="left") == "rigid blocks, stress at y = 20 m"
    assert lower.get_title(loc="left").startswith("less rigid blocks, exact")
    labels = {line.get_label() for line in upper.lines}
    assert {"undamped", "damped", "reference"} < labels
    assert "joints.damping_ratio" in first.caption


def test_terms_of_energy_add_up_to_the_work(pictures, comparisons):
    """But for the residual, which is at most that of the ledger, and is in the caption."""
    picture = pictures["energy"]
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


def test_a_term_of_energy_that_is_lost_is_seen_as_missing(comparisons):
    result = comparisons[1].results["dem"]
    lost = result.copy(deep=True)
    lost["energy"].loc[{"term": "viscous"}] = 0.0
    ledgers = ledgers_of([comparisons[0], replace(comparisons[1], results={"dem": lost})])
    viscous = result.energy.sel(term="viscous")
    share = float(viscous[-1] / result.energy.sel(term="work").max())
    assert share > 0.01
    assert ledgers[RESIDUAL].iloc[-1] == pytest.approx(-share, rel=1e-9)


def test_terms_of_energy_are_drawn_but_those_of_zero(pictures):
    """The residual has a logarithmic axis of its own."""
    picture = pictures["energy"]
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


def test_no_ledger_no_picture(pillar, compared):
    scene = pillar(time__duration=0.01, record__energy=False)
    assert energy("fig", compared(scene, by=("dem",))) == []
