"""All pictures of a scene together."""

import numpy as np
import pytest

from jointwave.compare.engines import solve
from jointwave.compare.figures.charts.waveforms import waveforms
from jointwave.compare.figures.scene_figures import figures_of, recorded_along
from jointwave.compare.figures.style import GIVEN
from jointwave.compare.misfit.alignment import align_curve
from jointwave.compare.misfit.external import Curves
from jointwave.compare.misfit.places import Place


@pytest.fixture(scope="module")
def comparisons(scene_with, compared):
    """Variants of one pillar, the second of them damped."""
    short = {"time.duration": 0.03}
    scenes = [scene_with(**short, **c) for c in ({}, {"joints.damping_ratio": 0.05})]
    return compared(scenes[0], scenes[1].model_copy(update={"name": "damped"}))


@pytest.fixture(scope="module")
def pictures(comparisons):
    fields = [
        {name: solve(name, recorded_along(c.scene)) for name in ("dem", "lattice")}
        for c in comparisons
    ]
    return figures_of("fig", comparisons, fields)


def test_pictures_come_in_the_order_of_the_page_each_under_its_own_name(pictures):
    assert [p.name.removeprefix("fig-") for p in pictures] == [
        *("scene", "variants", "waveforms", "space-time-0", "space-time-0-exact"),
        *("space-time-1", "space-time-1-exact", "spectra", "energy"),
    ]
    assert [p.title for p in pictures if "space-time" in p.name and not p.folded] == [
        "Stress along the pillar over time, undamped"
    ]


def test_no_picture_is_blank(pictures, ink):
    for picture in pictures:
        assert 0.005 < ink(picture.figure) < 0.6, picture.name
        assert len(picture.table) > 0 and picture.title and picture.caption


def test_tables_carry_units(pictures):
    bare = {"variant", "part", "what", "engine"}
    for picture in pictures:
        assert all(c in bare or c.endswith(")") for c in picture.table.columns), picture.name


def test_without_fields_there_are_no_diagrams(comparisons):
    assert not [p for p in figures_of("fig", comparisons, []) if "space-time" in p.name]


def every_solution(pictures):
    return next(p for p in pictures if p.name == "fig-waveforms")


def test_variants_stand_in_one_pair_of_axes_and_every_solution_in_a_fold(pictures):
    first, second = pictures[1:3]
    assert (first.folded, second.folded) == (False, True)
    upper, lower = first.figure.axes
    assert upper.get_title(loc="left") == "rigid blocks, stress at y = 20 m"
    assert lower.get_title(loc="left").startswith("less rigid blocks, exact")
    labels = {line.get_label() for line in upper.lines}
    assert {"undamped", "damped", "reference"} < labels
    assert "joints.damping_ratio" in first.caption


def test_waveforms_hold_the_numbers_of_the_table(pictures):
    """And under them the difference from the reference."""
    picture = every_solution(pictures)
    columns = list(picture.table.columns[1:])
    for i, (upper, lower) in enumerate([picture.figure.axes[:2], picture.figure.axes[2:]]):
        curves, rests = (
            {line.get_label(): line.get_ydata() for line in ax.lines} for ax in (upper, lower)
        )
        one, other = columns[2 * i : 2 * i + 2]
        pairs = (("rigid blocks", "dem", one), ("rigid blocks, exact", "lattice", other))
        for name, solver, column in pairs:
            assert column.startswith(f"{solver} | ")
            np.testing.assert_allclose(curves[name], 1e-6 * picture.table[column])
        rest = rests["rigid blocks"]
        expected = picture.table[one] - picture.table[other]
        np.testing.assert_allclose(rest / np.abs(rest).max(), expected / np.abs(expected).max())


def test_curves_of_others_stand_beside_at_their_own_times(pillar, compared):
    (comparison,) = compared(pillar(time__duration=0.03))
    time = np.array([0.0, 0.011, 0.017, 0.029])
    place = Place("stress", "", (20.0,))
    given = Curves("lab.csv", "lab.csv", time, {place: np.array([0.0, 1e5, 8e5, -2e5])})
    comparison.besides.append(align_curve(given, comparison.scene, comparison.results, False))
    (picture,) = waveforms("fig", [comparison])
    (line,) = (x for x in picture.figure.axes[0].lines if x.get_label() == "lab.csv")
    np.testing.assert_allclose(line.get_xdata(), 1e3 * time)
    np.testing.assert_allclose(line.get_ydata(), [0.0, 0.1, 0.8, -0.2])
    assert line.get_color() == GIVEN[0].colour
