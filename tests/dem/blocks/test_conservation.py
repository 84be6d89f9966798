"""What no law of a joint may change: momenta, and the sum of all energies."""

import numpy as np
import pytest

from jointwave.dem import simulate
from jointwave.results.dataset import energy_residual
from jointwave.results.snapshots import snapshots_of

DASHPOTS = {"damping_ratio": 0.05}
SLIP = {"friction_angle": 30.0, "cohesion": 2e4}
WORN = {"dynamic_friction_angle": 12.0, "weakening_distance": 2e-5}
WORN |= {"dilation_angle": 6.0, "dilation_distance": 4e-5, "residual_cohesion": 0.0}
RATE = {"direct_effect": 0.01, "evolution_effect": 0.015, "critical_slip_distance": 1e-5}
RATE |= {"reference_rate": 1e-6, "initial_state": 1.0, "cohesion": None}
LAWS = {
    "elastic": {},
    "dashpots": DASHPOTS,
    "no tension": {"tension": False},
    "slip": SLIP,
    "slip that weakens, lifts and loses its cohesion": SLIP | WORN | DASHPOTS,
    "rate and state": SLIP | RATE,
    "softening": {"tensile_strength": 5e4, "fracture_energy": 0.75},
}
#: Laws of steps in plain Python: no other test has their kernels.
PLAIN = ("slip that weakens, lifts and loses its cohesion", "rate and state")
#: In the step in which a joint opens its traction has a kink: tests/field_cases/test_open_ledgers.
OPEN = ("no tension", "softening")
AT, PUSH = np.array([6.2, 5.3]), 1e6 * np.array([0.6, 0.8])


def momenta(found):
    """Return the last momentum (N s/m) and moment of momentum about the origin (N s) of rock of
    2600 kg/m3: the velocity is linear in each triangle, so the middles of its edges are exact."""
    x, v = (a[found.cells][..., :2] for a in (found.points, found.velocity[-1]))
    (ax, ay), (bx, by) = (x[:, 1] - x[:, 0]).T, (x[:, 2] - x[:, 0]).T
    mass = 2600.0 * np.abs(ax * by - ay * bx) / 2
    x, v = ((a + np.roll(a, 1, axis=1)) / 2 for a in (x, v))
    spin = (x[..., 0] * v[..., 1] - x[..., 1] * v[..., 0]).mean(axis=1)
    return mass @ v.mean(axis=1), mass @ spin


@pytest.mark.parametrize("law", LAWS)
def test_momenta_are_those_of_the_force_and_the_ledger_closes(law, rock_mass, joint, request):
    """A free body under stress, pushed at a point by a step: F t, and its moment about the origin.
    What is stored and dissipated is what was put in, to round-off."""
    lasts = 0.004 if law in PLAIN else 0.01
    if law in PLAIN:
        request.getfixturevalue("plain")
    sets = [
        joint(name="bed", dip=20.0, spacing=2.0, **LAWS[law]),
        joint(name="cross", dip=-65.0, spacing=2.0, **LAWS[law]),
    ]
    force = {"kind": "force", "quantity": "force", "shape": "step", "amplitude": 1e6}
    own = rock_mass(
        boundaries=dict.fromkeys(("left", "right", "bottom", "top"), "free"),
        joint_sets=sets,
        loads=[force | {"at": AT.tolist(), "direction": [0.6, 0.8]}],
        numerics={"dem": {"block": None}},
        record={"points": [[3.0, 3.0]], "joints": None, "fields": lasts},
        time={"duration": lasts},
    )
    result = simulate(own)
    linear, angular = momenta(snapshots_of(result))
    assert linear == pytest.approx(PUSH * lasts, rel=1e-11)
    assert angular == pytest.approx((AT[0] * PUSH[1] - AT[1] * PUSH[0]) * lasts, rel=1e-10)

    energy = {term: result.energy.sel(term=term).values for term in result.term.values}
    largest = np.abs(result.energy.values).max()
    assert energy_residual(result) < (2e-3 if law in OPEN else 1e-12)
    assert (energy["viscous"][-1] > 1e-4 * largest) == ("damping_ratio" in LAWS[law])
    # A joint that opens gives off its shear energy.
    loses = "friction_angle" in LAWS[law] or law in OPEN
    assert (energy["friction"][-1] > 1e-4 * largest) == loses
    assert (energy["fracture"][-1] > 1e-6 * largest) == (law == "softening")
