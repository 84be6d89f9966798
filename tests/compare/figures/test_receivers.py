"""Which quantities and components panels and tables show of a receiver."""

import numpy as np
import pytest

from jointwave.cases.read import load_tables
from jointwave.compare.engines import solve
from jointwave.compare.exact.blocks import row_of_blocks
from jointwave.compare.figures.charts.waveforms import draw_solutions
from jointwave.compare.figures.receivers import curve_table, panels
from jointwave.compare.misfit.pairs import Comparison

RECORD = {"record__stress": [5.0], "record__velocity": [5.25], "time__duration": 0.01}
ACROSS = {"load__direction": [1.0, 0.0, 0.0]}
TWIST = {"load__arm": 0.2, "record__stress": []}


@pytest.fixture
def solved(pillar):
    """Return a function that gives a scene solved as a row of blocks, which is exact."""

    def solve_row(name="spatial-lattice", **changes):
        scene = pillar(**RECORD | changes)
        return Comparison(scene, {name: row_of_blocks.solve(scene)})

    return solve_row


@pytest.mark.parametrize(
    ("changes", "places"),
    [
        ({"load__direction": [0.0, 0.0, 1.0]}, ["shear z at y = 5 m", "velocity z at y = 5.25 m"]),
        (
            {"load__direction": [0.28, 0.96, 0.0]},
            [f"{one} at y = 5 m" for one in ("stress", "shear x")]
            + [f"velocity {axis} at y = 5.25 m" for axis in "xy"],
        ),
        (TWIST, ["rotation y at y = 5.25 m"]),
    ],
)
def test_a_panel_shows_a_component_that_moves(solved, changes, places):
    found = solved(**changes)
    (row,) = panels([found])
    assert [panel.place.heading for panel in row] == places
    for panel in row:
        values = panel.place.waveform(found.results["spatial-lattice"])
        np.testing.assert_array_equal(panel.curves["spatial-lattice"], values)


def test_nothing_moves_sideways_at_a_level_joint(one_joint):
    record = {"points": [[10.0, 5.0]], "joints": [[10.0, 10.0]], "interval": 1e-4}
    tables = one_joint(domain={"size": [20.0, 20.0]}, time={"duration": 0.02}, record=record)
    tables["joint_sets"][0] |= {"through": [10.0, 10.0], "dip": 0.0}
    scene = load_tables(tables)
    (row,) = panels([Comparison(scene, {"oblique-joint": solve("oblique-joint", scene)})])
    places = ["velocity y at [10, 5] m", "traction n at [10, 10] m"]
    assert [panel.place.heading for panel in row] == places


def test_variants_of_different_motion_share_a_figure_and_a_table(solved):
    """Axial, spatial and twisted: each panel has its own unit, each column its full heading."""
    turning = solved(record__velocity=[5.25, 9.75], **TWIST)
    found = [solved("lattice"), solved(**ACROSS), turning]
    labels = [ax.get_ylabel() for ax in draw_solutions(found).axes]
    assert [label for label in labels if label] == [
        *("stress (MPa)", "velocity (m/s)", "shear (MPa)", "velocity (m/s)"),
        *("rotation (mrad)", "rotation (mrad)"),
    ]
    units = [column.rpartition("(")[2] for column in curve_table(found)][1:]
    assert units == ["Pa)", "m/s)", "Pa)", "m/s)", "rad)", "rad)"]


def test_variants_of_other_durations_share_one_table(solved):
    """Where a shorter variant has no sample the cell is empty."""
    found = [solved("lattice", record__velocity=[], time__duration=t) for t in (0.01, 0.02)]
    found[1].scene = found[1].scene.model_copy(update={"name": "long"})
    table = curve_table(found)
    assert table.shape == (401, 3) and table.isna().sum().tolist() == [0, 200, 0]


def test_what_moves_is_drawn_not_what_stands(solved):
    """A shear wave under a prestress that is larger: the transmitted shear, in every panel."""
    shear = ACROSS | {"motion__rotation": "none"}
    plain, found = (panels([solved(prestress__normal=n, **shear)])[0] for n in (0.0, 1e7))
    for panel, other in zip(found, plain, strict=True):
        assert panel.place == other.place and panel.at_rest == 0
        curve, same = panel.curves.to_numpy(), other.curves.to_numpy()
        np.testing.assert_allclose(curve, same, atol=1e-9 * np.abs(same).max())
    assert found[0].place.heading == "shear x at y = 5 m"


def test_the_static_state_is_taken_from_a_waveform_and_said(solved):
    """The motion is drawn; the table contains the recorded values."""
    found = [solved("lattice", prestress__normal=normal) for normal in (0.0, 2e6)]
    (moving, _), (stressed, _) = panels(found)
    assert (moving.at_rest, stressed.at_rest) == (0.0, pytest.approx(2e6))
    np.testing.assert_allclose(stressed.curves["lattice"], moving.curves["lattice"], atol=1e-3)
    upper = draw_solutions(found[1:]).axes[0]
    assert upper.get_ylabel() == "stress (MPa)\nless 2 at rest"
    assert np.abs(upper.lines[1].get_ydata()).max() < 1.1
    assert curve_table(found[1:]).iloc[0, 1] == pytest.approx(2e6)
