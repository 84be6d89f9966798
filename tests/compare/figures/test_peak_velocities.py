"""Maps of the peak particle velocity."""

import numpy as np
import pytest

from jointwave.cases.read import load_tables
from jointwave.compare.figures.body_maps import maps_of
from jointwave.compare.figures.charts.maps import peak_velocities


@pytest.fixture(scope="module")
def comparison(compared):
    """Return square blocks without a Poisson effect that a P wave crosses upwards."""
    sides = {"left": "free", "right": "free", "bottom": "quiet", "top": "quiet"}
    sets = [
        {"name": str(dip), "dip": dip, "spacing": 1.0, "normal_stiffness": 1e12}
        | {"shear_stiffness": 4e11}
        for dip in (0.0, 90.0)
    ]
    scene = load_tables(
        {
            "title": "a wave",
            "domain": {"size": [4.0, 6.0]},
            "rock": {"density": 2500.0, "intact_modulus": 4e10, "intact_poisson": 0.0},
            "joint_sets": sets,
            "waves": [
                {"kind": "P", "direction": [0.0, 1.0], "shape": "ricker"}
                | {"amplitude": 0.2, "quantity": "velocity", "period": 0.01}
            ],
            "boundaries": sides,
            "time": {"duration": 0.03},
            "record": {"points": [[2.5, 2.5]], "fields": 1e-4},
        }
    )
    return compared(scene, by=("dem",))[0]


def test_the_map_is_the_peak_of_each_block(comparison):
    """At the receiver that of its waveform: a peak of omega = 2 pi / T is missed by (omega dt)^2/8
    at most between snapshots. Cells fill the domain."""
    (found,) = maps_of(comparison.scene, [comparison.results["dem"]], "ppv").values()
    corners, peaks = found.corners, found.values
    middle = corners.mean(axis=1)
    here = np.abs(middle - [2.5, 2.5]).max(axis=1) < 0.5
    wave = comparison.results["dem"].velocity.values[0]
    missed = (2 * np.pi / 0.01 * 1e-4) ** 2 / 8
    assert peaks[here] == pytest.approx(np.hypot(*wave.T).max(), rel=2 * missed)
    assert peaks.min() > 0.18
    x, y = np.moveaxis(corners, 2, 0)
    twice = (x * np.roll(y, -1, axis=1) - np.roll(x, -1, axis=1) * y).sum(axis=1)
    assert np.abs(twice).sum() / 2 == pytest.approx(24.0, rel=1e-12)


def test_the_picture_has_its_numbers(comparison, ink):
    (found,) = peak_velocities("wave", [comparison])
    assert found.table["peak velocity (m/s)"].max() == pytest.approx(0.2, rel=0.05)
    assert ink(found.figure) > 0.05
