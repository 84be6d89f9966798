"""Which quantities and components panels show."""

import numpy as np
import pytest

from jointwave.compare.exact.blocks import row_of_blocks
from jointwave.compare.figures.charts.waveforms import draw_solutions
from jointwave.compare.figures.receivers import curve_table, panels
from jointwave.compare.misfit.pairs import Comparison

RECORD = {"record__stress": [5.0], "record__velocity": [5.25], "time__duration": 0.01}
TWIST = {"load__arm": 0.2, "record__stress": []}


def comparison(pillar, name="spatial-lattice", **changes):
    """Return a scene solved by one exact solution."""
    scene = pillar(**RECORD | changes)
    return Comparison(scene, {name: row_of_blocks.solve(scene)})


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
def test_a_panel_shows_a_component_that_moves(pillar, changes, places):
    found = comparison(pillar, **changes)
    (row,) = panels([found])
    assert [panel.place.heading for panel in row] == places
    for panel in row:
        values = panel.place.waveform(found.results["spatial-lattice"])
        np.testing.assert_array_equal(panel.curves["spatial-lattice"], values)


def test_variants_of_different_motion_share_a_figure_and_a_table(pillar):
    """Axial, spatial and twisted: each panel has its own unit, each column its full heading."""
    found = [
        comparison(pillar, "lattice"),
        comparison(pillar, load__direction=[1.0, 0.0, 0.0]),
        comparison(pillar, record__velocity=[5.25, 9.75], **TWIST),
    ]
    labels = [ax.get_ylabel() for ax in draw_solutions(found).axes]
    assert [label for label in labels if label] == [
        "stress (MPa)",
        "velocity (m/s)",
        "shear (MPa)",
        "velocity (m/s)",
        "rotation (mrad)",
        "rotation (mrad)",
    ]
    units = [column.rpartition("(")[2] for column in curve_table(found)][1:]
    assert units == ["Pa)", "m/s)", "Pa)", "m/s)", "rad)", "rad)"]


SHEAR = {"load__direction": [1.0, 0.0, 0.0], "motion__rotation": "none"}


@pytest.mark.parametrize("normal", [1e5, 1e7])
def test_what_moves_is_drawn_not_what_stands(pillar, normal):
    """A shear wave under a prestress that is larger: the transmitted shear, in every panel."""
    plain = comparison(pillar, **SHEAR)
    found = comparison(pillar, prestress__normal=normal, **SHEAR)
    for panel, other in zip(panels([found])[0], panels([plain])[0], strict=True):
        assert panel.place == other.place and panel.at_rest == 0
        curve, same = panel.curves.to_numpy(), other.curves.to_numpy()
        np.testing.assert_allclose(curve, same, atol=1e-9 * np.abs(same).max())
    assert panels([found])[0][0].place.heading == "shear x at y = 5 m"


def test_the_static_state_is_taken_from_a_waveform_and_said(pillar):
    """The motion is drawn; the table contains the recorded values."""
    scenes = [pillar(**RECORD, prestress__normal=normal) for normal in (0.0, 2e6)]
    found = [Comparison(scene, {"lattice": row_of_blocks.solve(scene)}) for scene in scenes]
    (moving, _), (stressed, _) = panels(found)
    assert (moving.at_rest, stressed.at_rest) == (0.0, pytest.approx(2e6))
    np.testing.assert_allclose(stressed.curves["lattice"], moving.curves["lattice"], atol=1e-3)
    upper = draw_solutions(found[1:]).axes[0]
    assert upper.get_ylabel() == "stress (MPa)\nless 2 at rest"
    assert np.abs(upper.lines[1].get_ydata()).max() < 1.1
    column = curve_table(found[1:]).iloc[:, 1]
    assert column.iloc[0] == pytest.approx(2e6)


def test_gravity_that_stands_is_no_motion(pillar):
    """Where it is there from the start, the first sample is at rest."""
    scene = pillar(**RECORD, gravity__direction=[0.0, 1.0, 0.0], ends__end="fixed")
    found = Comparison(scene, {"lattice": row_of_blocks.solve(scene)})
    stress, _ = panels([found])[0]
    assert stress.at_rest == pytest.approx(2400 * 9.81 * 5.0, rel=0.02)
    assert stress.curves["lattice"].iloc[0] == 0
