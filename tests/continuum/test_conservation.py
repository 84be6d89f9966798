"""What is kept: the energy ledger, momentum of free bodies, mirror images, and drag."""

import numpy as np
import pytest

from jointwave.continuum.run import simulate
from jointwave.continuum.stepping.leapfrog import Leapfrog
from jointwave.results.dataset import energy_residual
from tests.continuum.bodies import blow, oblique
from tests.continuum.stacked import Force, joined, problem, stack

SOFT = [{"y": 1.0, "spacing_stiffness": 4e8, "shear_stiffness": 5e8, "damping_ratio": 0.1}]
SLIP = {"friction_angle": 20.0, "cohesion": 1e4}
QUIET = "damped, quiet and matched"
SHAKEN = "damped, shaken base, weight"
SLIDES = "slides"
#: With a dashpot beside it friction may still point against the slide where the motion turns.
DAMPED = "slides, damped"
KINDS = {
    QUIET: {
        "soft_layers": SOFT,
        "damping__mass_proportional": 50.0,
        "ends": {"start": "quiet", "end": "matched"},
        "joints__damping_ratio": 0.05,
    },
    SHAKEN: {
        "soft_layers": SOFT,
        "joints__damping_ratio": 0.02,
        "damping__mass_proportional": 50.0,
        "ends": {"start": "fixed", "end": "matched"},
        "gravity": {"static": False},
        "load": {"shape": "sine", "amplitude": 0.1, "period": 1e-3, "quantity": "velocity"},
    },
    SLIDES: {"joints": SLIP},
    DAMPED: {
        "joints": SLIP | {"damping_ratio": 0.05},
        "prestress": {"normal": 1e5},
        "time__duration": 1.2e-3,
    },
}
SIMPLEX = {"cell": "simplex", "scheme": "explicit", "order": 1}


@pytest.mark.parametrize(
    ("kind", "model", "dim", "numerics"),
    [
        (QUIET, "jointed", 3, {}),
        (SHAKEN, "jointed", 3, {}),
        (QUIET, "jointed", 3, SIMPLEX),
        (SHAKEN, "equivalent", 1, {}),
        (SLIDES, "jointed", 3, {}),
        (DAMPED, "jointed", 2, {}),
    ],
)
def test_the_ledger_closes_to_round_off(short, kind, model, dim, numerics, request):
    """Where every force is linear, and where joints slide: friction books the mean of the spring
    force before and after the step, which closes."""
    if kind == DAMPED:  # no other test has its kernel
        request.getfixturevalue("plain")
    given = dict(KINDS[kind])
    for key in {"load", "gravity"} & given.keys():
        given[key] = given[key] | {"direction": oblique(dim)}
    result = simulate(short(numerics, **{"load": blow(dim)} | given), model, dim=dim)
    assert energy_residual(result) < 1e-11
    terms = set(result["term"].values)
    assert ("gravity" in terms) == ("gravity" in given)
    assert ("friction" in terms) == (kind in (SLIDES, DAMPED))
    spent = result["energy"].sel(term="friction" if kind == SLIDES else "viscous").values
    assert spent[-1] > 0 and np.diff(spent).min() >= -1e-12 * np.abs(spent).max()
    if "friction" in terms:
        slid, work = (result["energy"].sel(term=term).values for term in ("friction", "work"))
        assert slid[-1] > 1e-3 * work.max()


@pytest.mark.parametrize("zeta", [None, 0.02])
def test_no_tension_joints_never_pull_and_lose_no_energy(pillar, zeta):
    """Opening and closing between steps costs order dt^2, below 1e-3 at the default step."""
    damping = {} if zeta is None else {"joints__damping_ratio": zeta}
    places = np.arange(0.5, 50.0, 0.5).tolist()
    record = {"record__stress": places, "record__velocity": [25.0]}
    result = simulate(pillar(joints__tension=False, **record, **damping))
    peak = float(result["stress"].max())
    assert float(result["stress"].min()) > -1e-10 * peak
    assert energy_residual(result) < 1e-3
    assert 0.5e6 < peak < 1.1e6


JOINTS = {
    "slip": {"friction": np.full(2, 0.3), "cohesion": np.full(2, 0.01)},
    "no tension": {"tension": np.zeros(2, bool)},
}
WAYS = {2: [0.6, -0.8], 3: [0.48, -0.64, -0.6]}


@pytest.mark.parametrize(("dim", "joints"), [(2, "no tension"), (3, "slip")])
def test_momenta_are_the_impulse_of_the_load(dim, joints):
    """Of an eccentric blow, whatever the joints do: their tractions act at one place on both sides.
    The lever of a node is its unloaded place."""
    body = stack(dim, 3, 2, 1, order=1)
    corner = body.x.sum(axis=1).argmax()
    freedom = dim * corner + np.arange(dim)
    own = problem(body, joined(2, **JOINTS[joints]))
    dt = 0.3 * own.critical_step()
    push = Force(freedom, np.array(WAYS[dim]), lambda t: 0.2 * np.sin(t), dt)
    steps = Leapfrog(own._replace(forces=push), dt, 1)
    steps.take(0, 200, 1000)
    impulse = dt * push.at(0, 200).sum(axis=0)
    momentum = (body.mass * steps.v).reshape(-1, dim)
    arms, force = np.zeros((len(body.x), 3)), np.zeros((len(body.x), 3))
    arms[:, :dim], force[:, :dim] = body.x, momentum
    blow = np.append(impulse, np.zeros(3 - dim))
    turn = np.cross(arms[corner], blow)
    np.testing.assert_allclose(force.sum(axis=0), blow, atol=1e-11 * np.abs(blow).max())
    found = np.cross(arms, force).sum(axis=0)
    np.testing.assert_allclose(found, turn, atol=1e-11 * np.abs(turn).max())
    if joints == "slip":
        assert steps.state.sums[1] > 0


@pytest.mark.parametrize("mirror", [0, 2], ids=["x", "z"])
def test_a_mirrored_blow_gives_the_mirrored_motion(mirror, short):
    """x to -x: the displacement along x and the turns about y and z change their signs; z alike.
    Open and damped joints have either axis alike by `test_dimensions.py`."""
    signs = np.ones(3)
    signs[mirror] = -1

    def struck(signs):
        way, at = signs * [0.48, 0.6, -0.64], signs[[0, 2]] * [0.1, -0.05]
        load = {"shape": "sine", "amplitude": 1e5, "period": 1e-3}
        load |= {"direction": way.tolist(), "at": at.tolist()}
        return simulate(short(load=load, joints=SLIP, numerics__continuum__order=1), dim=3)

    one, other = struck(np.ones(3)), struck(signs)
    changes = {"stress": 1.0, "shear": signs[[0, 2]], "velocity": signs, "rotation": -signs}
    for name, change in changes.items():
        known = one[name].values * change
        assert np.abs(other[name].values - known).max() < 1e-10 * np.abs(known).max() > 0


def test_drag_on_rock_that_drifts_strains_nothing():
    """v shrinks by (1 - a) / (1 + a), a = alpha dt / 2, at every step."""
    body, alpha = stack(2, 3, 2, 1, order=1), 0.5
    own = problem(body, joined(2), alpha=alpha)
    dt = 0.3 * own.critical_step()
    steps = Leapfrog(own, dt, 1)
    drift = np.tile([0.3, -0.7], len(body.x))
    for before in (steps.state.v, steps.state.v_before):
        steps.place(drift, before)
    steps.take(0, 51, 1000)
    a = alpha * dt / 2
    shrinks = ((1 - a) / (1 + a)) ** 51
    assert shrinks < 0.3
    np.testing.assert_allclose(steps.v, drift * shrinks, rtol=0, atol=1e-12)
