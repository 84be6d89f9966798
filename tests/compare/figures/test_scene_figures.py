"""All pictures of a scene together."""

import pytest

from jointwave.compare.engines import solve
from jointwave.compare.figures.scene_figures import figures_of, recorded_along


@pytest.fixture(scope="module")
def comparisons(scene_with, compared):
    """Variants of one pillar, the second of them damped."""
    short = {"time.duration": 0.03}
    scenes = [scene_with(**short, **c) for c in ({}, {"joints.damping_ratio": 0.05})]
    return compared(scenes[0], scenes[1].model_copy(update={"name": "damped"}))


@pytest.fixture(scope="module")
def pictures(comparisons):
    """Return the pictures by name."""
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
