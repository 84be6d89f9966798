"""Round-off against leapfrog's closed form: shear, torsion, and a blow that does everything."""

import numpy as np
import pytest

from closed_forms import leapfrog
from jointwave import dem
from jointwave.cases.loads import load_history, step_means
from jointwave.cases.material.calibrate import calibrate
from jointwave.compare.exact.blocks.pillar import bodies, drive_vector
from jointwave.compare.exact.blocks.system import relative

TWO_TILES = {"pillar__length": 50.0, "time__duration": 0.05}
BLOWS = {
    "shear of blocks that do not turn": {
        "motion__rotation": "none",
        "load__at": [0.0, 0.0],
        **TWO_TILES,
    },
    "torsion": {
        "load": {
            "shape": "sine",
            "amplitude": 1e6,
            "period": 0.01,
            "direction": [0, 1, 0],
            "arm": 0.1,
        },
        **TWO_TILES,
    },
    "eccentric blow": {"load__direction": [0, 1, 0], **TWO_TILES},
    "oblique blow, fixed end": {"ends__end": "fixed", **TWO_TILES},
    "slender, one block in the third tile": {
        "pillar__length": 64.5,
        "pillar__side": 0.2,
        "load__at": [0.05, 0.0],
        "record__stress": [],
        "time__duration": 0.04,
    },
}


def closed_form(scene, dt, steps):
    """Return displacements and rotations [6, N] of leapfrog after so many steps of dt (s)."""
    stress, (mass, contacts) = step_means(load_history(scene), dt, steps), bodies(scene)
    count, c = scene.block_count, mass.shape[1]
    place = relative(contacts, *mass.shape)[:c, : count * c].T @ drive_vector(scene)[:c]
    modes = leapfrog.modes_of_blocks(mass, contacts)
    u = leapfrog.of_modes(modes, place, stress, np.array([steps]), dt)
    found = np.zeros((6, count))
    found[:c] = u.reshape(count, c).T
    return found


@pytest.mark.parametrize("changes", BLOWS.values(), ids=BLOWS)
def test_closed_form_of_leapfrog_after_five_thousand_steps(row, changes):
    """Round-off grows with the steps, not with the error: below 1e-10 of the largest, and where
    nothing moves, up to round-off of the modes, of what turns at the face's edge."""
    probe = calibrate(row(**changes))
    y = (probe.spacing * (np.arange(probe.block_count) + 0.5)).tolist()
    record = {"velocity": y, "interval": 0.02 / 5}
    scene = row(**changes, record=record, numerics__dem__step_fraction=0.02)
    result = dem.simulate(scene)
    assert result.attrs["steps"] >= 5000
    moved = np.zeros((6, probe.block_count))
    moved[:3] = result.displacement.values[:, -1].T
    if "rotation" in result:
        moved[3:] = result.rotation.values[:, -1].T
    expected = closed_form(scene, result.attrs["dt"], result.attrs["steps"])
    arm = scene.pillar.side / 2
    size = np.abs(expected[:3]).max() + arm * np.abs(expected[3:]).max()
    for kind, of in ((slice(0, 3), size), (slice(3, 6), size / arm)):
        assert np.abs(moved - expected)[kind].max() <= 1e-10 * of
