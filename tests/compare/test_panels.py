"""Which quantity and component a panel shows."""

import numpy as np
import pytest

from compare.exact import lattice, spatial_lattice
from compare.figures import draw
from compare.pairs import Comparison
from compare.panels import curve_table, panels

RECORD = {"record__stress": [5.0], "record__velocity": [5.25], "time__duration": 0.01}
TWIST = {"load__arm": 0.2, "record__stress": []}


def comparison(pillar, solution=spatial_lattice, **changes):
    """Return a scene solved by one exact solution."""
    scene = pillar(**RECORD | changes)
    return Comparison(scene, {solution.NAME: solution.solve(scene)})


@pytest.mark.parametrize(
    ("changes", "places"),
    [
        ({"load__direction": [0.0, 0.0, 1.0]}, ["shear z at y = 5 m", "velocity z at y = 5.25 m"]),
        ({"load__direction": [0.28, 0.96, 0.0]}, ["stress at y = 5 m", "velocity y at y = 5.25 m"]),
        (TWIST, ["rotation y at y = 5.25 m"]),
    ],
)
def test_panel_shows_the_component_that_moves_most(pillar, changes, places):
    found = comparison(pillar, **changes)
    (row,) = panels([found])
    assert [panel.place for panel in row] == places
    for panel in row:
        values = found.results["spatial-lattice"][panel.quantity].values
        assert panel.curves["spatial-lattice"].abs().max() == np.abs(values).max()


def test_variants_of_different_motion_share_a_figure_and_a_table(pillar):
    """Axial, spatial and twisted: each panel has its own unit, each column says what it is."""
    found = [
        comparison(pillar, lattice),
        comparison(pillar, load__direction=[1.0, 0.0, 0.0]),
        comparison(pillar, record__velocity=[5.25, 9.75], **TWIST),
    ]
    labels = [ax.get_ylabel() for ax in draw("fig", found).axes]
    assert labels == [
        "stress (MPa)",
        "velocity (m/s)",
        "shear (MPa)",
        "velocity (m/s)",
        "rotation (mrad)",
        "rotation (mrad)",
    ]
    units = [column.rpartition("(")[2] for column in curve_table(found)]
    assert units == ["Pa)", "m/s)", "Pa)", "m/s)", "rad)", "rad)"]
