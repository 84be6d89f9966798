"""The balance of energy of a point, and that no direction is preferred, as engines rely on."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from jointwave.joints.dilation import lift
from jointwave.joints.law import History, Law
from jointwave.joints.tangent import tangent
from tests.joints.points import DT, RATE, at_point, march, some

PLAIN = Law(9e9, shear_stiffness=3e9)
DAMPED = {"normal_viscosity": 1e5, "shear_viscosity": 3e4}
COULOMB = PLAIN._replace(cohesion=1e5, friction=0.5)
LAWS = {
    "elastic": PLAIN,
    "dashpots": PLAIN._replace(**DAMPED),
    "no tension": PLAIN._replace(carries_tension=False),
    "slip": COULOMB,
    "slip with dashpots": COULOMB._replace(**DAMPED),
    "residual": COULOMB._replace(residual_cohesion=2e4),
    "softening": COULOMB._replace(tensile_strength=1e5, critical_opening=1e-4),
    "closure": COULOMB._replace(maximum_closure=3e-4, rock_compliance=0.0),
    "weakening": COULOMB._replace(dynamic_friction=0.2, weakening_distance=2e-4, **DAMPED),
    "dilation": COULOMB._replace(dilation=0.2, dilation_distance=2e-4, **DAMPED),
    "rate and state": COULOMB._replace(**RATE),
}
#: Jumps (gap, slips), m: 0.1 mm.
unit = some(-1, 1).map(lambda x: 1e-4 * x)
paths = st.lists(st.tuples(unit, unit, unit), min_size=2, max_size=12)


def with_kinks(one, path):
    """Return a path with a node wherever its gap crosses a kink of the normal traction, between
    which it is linear: at zero, and of softening at w_0, w_c and the largest opening so far."""
    kinks, opening, fine = [0.0], 0.0, [np.zeros(3)]
    if one.tensile_strength is not None:
        kinks += [one.tensile_strength / one.normal_stiffness, one.critical_opening]
    for a, b in pairwise([np.zeros(3), *map(np.array, path)]):
        shares = [(k - a[0]) / (b[0] - a[0]) for k in {*kinks, opening} if b[0] != a[0]]
        fine += [a + (b - a) * share for share in sorted(shares) if 0 < share < 1] + [b]
        opening = max(opening, b[0])
    return fine


@pytest.mark.parametrize("name", sorted(set(LAWS) - {"closure"}))
@given(path=paths)
def test_balance_closes_at_every_step(name, path):
    """Mean traction of both ends of a step times its jump, as leapfrog's ledger has it, is what
    the springs store, what opening and sliding take and what the dashpots' share does. A lift that
    grows in the step counts with both its ends."""
    nodes = with_kinks(LAWS[name], path) if name in ("no tension", "softening") else path
    for step, before, now in march(LAWS[name], nodes):
        work, drag = (
            -0.5 * np.array([part(before), part(now)]).sum(axis=0) @ step
            for part in (lambda t: np.array(t[:3]), lambda t: np.array(t[3:6]))
        )
        gained = now.stored - before.stored + now.spent - before.spent
        size = before.stored + now.stored + (np.abs([before[:6], now[:6]]).max() * 2e-4)
        size += 0.0 if nodes is path else 9e9 * 1e-8  # of the round-off of the nodes
        assert work == pytest.approx(gained + now.slid + drag, abs=1e-12 * size)
        assert now.spent >= before.spent


KINDS = ("Coulomb", "weakening", "dilation", "both", "rate and state")


@st.composite
def slipping(draw, kind, opens=("ties", "no tension", "closes")):
    """Return a joint that slides, with or without dashpots."""
    opens, stiff = draw(st.sampled_from(opens)), kind not in ("Coulomb", "weakening")
    shear = 3e9 if stiff else 1e9 * draw(some(0.1, 100))
    eta = 1e-4 * draw(some(0.001, 10)) if draw(st.booleans()) else None
    friction, cohesion, more = draw(some(0.01, 2)), 1e6 * draw(some(0, 1)), {}
    if kind in ("weakening", "both"):
        more["dynamic_friction"] = friction * draw(some(0, 1))
        more["weakening_distance"] = 1e-4 * draw(some(0.1 if stiff else 0.01, 10))
    if kind in ("dilation", "both"):
        more["dilation"] = more.get("dynamic_friction", friction) * draw(some(0, 1))
        more["dilation_distance"] = 1e-4 * draw(some(0.1, 10))
    if kind == "rate and state":
        effects = {"direct_effect": draw(some(0.01, 1)), "evolution_effect": draw(some(0, 1))}
        more |= {name: 0.03 * value for name, value in effects.items()}
        more |= {"critical_slip_distance": 1e-4, "reference_rate": 1e-6}
        more["initial_state"] = 10 ** draw(st.floats(-4, 4))
    if kind == "Coulomb":
        more["residual_cohesion"] = cohesion * draw(some(0, 1))
    if opens == "closes":
        more |= {"maximum_closure": 3e-4, "rock_compliance": 0.0}
    return Law(
        normal_stiffness=9e9,
        normal_viscosity=eta and 9e9 * eta,
        carries_tension=None if opens == "ties" else False,
        shear_stiffness=shear,
        shear_viscosity=eta and shear * eta,
        cohesion=cohesion,
        friction=friction,
        **more,
    )


def stiffness(one):
    """Return what resists a step, springs and dashpots, Pa/m."""
    both = np.array([one.normal_stiffness, one.shear_stiffness])
    return both + np.array([one.normal_viscosity or 0.0, one.shear_viscosity or 0.0]) / DT


@pytest.mark.parametrize("kind", KINDS)
@given(data=st.data())
def test_no_step_creates_energy_and_a_slide_only_dissipates(kind, data):
    """Work on the joint over a step, of the tractions at its end, >= change of what is stored: both
    energies are convex, dashpots and slides take the rest. So a closed cycle of slip, under
    whatever prestress, gives nothing: what is stored is of the state alone. Of a slide's work the
    lift takes t_n dw, no more: the angle of dilation is at most that of friction."""
    one = data.draw(slipping(kind))
    law, steep = at_point(one)[0], 1e6 if one.maximum_closure is not None else 1.0
    for step, before, now in march(one, data.draw(paths)):
        t, change = np.array(now[:3]), now.stored - before.stored
        size = np.abs(t).sum() * 4e-4 + abs(change) + (2e-4) ** 2 * stiffness(one).sum()
        assert -t @ step >= change - 1e-12 * steep * size
        old, new = before.history, now.history
        slide = np.array([new.slide_x - old.slide_x, new.slide_z - old.slide_z])
        up = lift(law, new.path) - lift(law, old.path) if one.dilation is not None else 0.0
        assert up >= 0
        round_off = 1e-12 * steep * size + 1e-9 * np.abs(t).sum() * np.linalg.norm(slide)
        assert -t[1:] @ slide >= max(t[0], 0.0) * up - round_off


@pytest.mark.parametrize("kind", KINDS)
@given(data=st.data(), angle=some(0, 6.3))
def test_no_direction_along_the_joint_is_special(kind, data, angle):
    """Slips turned in the plane of the joint turn the tractions, and leave path or state alone."""
    one, path = data.draw(slipping(kind, ("ties", "no tension"))), data.draw(paths)
    one = one._replace(residual_cohesion=None)  # or round-off decides on the edge of slip
    if one.weakening_distance is not None:  # and where a joint snaps; this one's does not halve
        most = 2 * 9e5 * one.friction / one.shear_stiffness
        one = one._replace(weakening_distance=max(one.weakening_distance, most))
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    turned, scale = [(gap, *(turn @ slip)) for gap, *slip in path], 0.0
    within = 1e-13 if kind in ("Coulomb", "weakening") else 1e-10
    for (_, _, now), (_, _, other) in zip(march(one, path), march(one, turned), strict=True):
        scale += 4e-4 * stiffness(one).sum()
        assert other[0] == pytest.approx(now[0], abs=within * scale)
        assert other[1:3] == pytest.approx(turn @ now[1:3], abs=within * scale)
        assert other.history.path == pytest.approx(now.history.path, abs=1e-8)


@pytest.mark.parametrize("name", LAWS)
@given(path=paths)
def test_slip_in_one_direction_is_slip_in_two_without_the_other(name, path):
    """To round-off: tractions, history, balance and tangent."""
    one = LAWS[name]
    law, parts = at_point(one)
    line = [(gap, x, 0.0) for gap, x, _ in path]
    both = march(one, line), march(one, line, planar=True)
    for (_, _, whole), (_, _, planar) in zip(*both, strict=True):
        size = 9e9 * 1e-4 + 1e5 * 20
        assert planar[:6] == pytest.approx(whole[:6], rel=1e-9, abs=1e-9 * size)
        assert planar.history == pytest.approx(whole.history, rel=1e-9, abs=1e-12)
        assert planar[7:] == pytest.approx(whole[7:], rel=1e-8, abs=1e-9 * size * 1e-4)
    for gap, x, _ in path:
        point = (gap, x, 0.0), (1e4 * gap, 1e4 * x, 0.0), DT, History(cohesion=1e5), 1e3
        whole = tangent(law, parts, *point)
        planar = tangent(law, parts._replace(planar=True), *point)
        for name in ("nn", "xn", "xx", "nx"):
            expected = pytest.approx(getattr(whole, name), rel=1e-8, abs=1.0)
            assert getattr(planar, name) == expected
