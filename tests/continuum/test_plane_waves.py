"""Waves in rock masses in the plane, of one rock and of several, against their exact solutions."""

import numpy as np
import pytest

from closed_forms.quiet_face import coefficients
from jointwave.cases.incident import FreeField, PlaneWave, plane_wave
from jointwave.cases.loads import history_of
from jointwave.compare.engines import solve
from jointwave.compare.exact.rock_mass.field import field_of
from jointwave.compare.exact.rock_mass.stack_waves import ONE_JOINT
from jointwave.compare.misfit.metrics import relative_l2
from jointwave.continuum import simulate
from jointwave.results.dataset import energy_residual
from tests.turned import turned

QUIET = dict.fromkeys(("left", "right", "bottom", "top"), "quiet")
ROCK = {"density": 2600.0, "intact_modulus": 5e10}


@pytest.fixture
def struck(rock_mass):
    """Return a function that gives 20 m x 20 m of rock with quiet sides and one joint, which a
    Ricker pulse of 5 ms meets; keyword arguments of the wave, and tables as for `rock_mass`."""

    def scene(
        kind="P", direction=(0.0, 1.0), dip=30.0, through=(0.0, -4.0), joints=None, continuum=None,
        **tables,
    ):  # fmt: skip
        pulse = {"shape": "ricker", "amplitude": 1e6, "period": 5e-3}
        wave = {"kind": kind, "direction": list(direction), "through": list(through), **pulse}
        table = {
            "domain": {"size": [20.0, 20.0]},
            "rock": ROCK,
            "waves": [wave],
            "boundaries": QUIET,
            "time": {"duration": 0.016},
            "record": {"points": [[10.0, 5.0], [10.0, 15.0]], "joints": [[10.0, 10.0]]},
        }
        joints = [{"dip": dip, "through": [10.0, 10.0]}] if joints is None else joints
        own = {"order": 2} | ({"size": 1.25} if continuum is None else continuum)
        return rock_mass(*joints, continuum=own, **{**table, **tables})

    return scene


@pytest.mark.parametrize("kind, dip", [("P", 0.0), ("S", 0.0), ("P", 30.0), ("S", 30.0)])
def test_a_pulse_at_one_joint_is_the_exact_one(kind, dip, struck):
    """At 11 elements a wavelength of S waves, of order 2, with the exact field at all sides."""
    scene = struck(kind, dip=dip)
    found, exact = simulate(scene, incident=field_of(scene)), ONE_JOINT.run(scene)
    opens, slips = (np.abs(exact[name]).max() for name in ("gap", "slip"))
    names = [name for name, by in (("gap", opens), ("slip", slips)) if by > 1e-6 * (opens + slips)]
    for name in ("velocity", "displacement", "stress", "traction", *names):
        assert max(map(relative_l2, found[name].values, exact[name].values)) < 2e-3
    assert energy_residual(found) < 1e-11


def test_a_joint_is_read_by_one_element_as_wide_as_the_period(struck):
    """Both ends of its facet are one node."""
    sides = dict.fromkeys(("left", "right"), "periodic") | dict.fromkeys(("bottom", "top"), "quiet")
    record = {"points": [[2.0, 5.0]], "joints": [[2.0, 10.0], [4.9, 10.0]]}
    tables = {"domain": {"size": [5.0, 20.0]}, "boundaries": sides, "record": record}
    joints = [{"dip": 0.0, "through": [2.0, 10.0]}]
    scene = struck("P", joints=joints, continuum={"size": 5.0, "order": 4}, **tables)
    found, exact = simulate(scene, incident=field_of(scene)), ONE_JOINT.run(scene)
    for name in ("traction", "gap"):
        assert max(map(relative_l2, found[name].values, exact[name].values)) < 2e-3


def sent_back(scene, shares):
    """Return the P and SV wave that the top sends back of the wave of a scene, in time with it, of
    these shares of its amplitude."""
    (wave,) = scene.waves
    one, found = plane_wave(scene, wave), []
    corner = np.array([0.0, 20.0])
    speeds = one.rock.p_speed, one.rock.s_speed
    for k, (speed, share) in enumerate(zip(speeds, shares, strict=True)):
        along = float(speed) * one.direction[0] / one.speed
        back = np.array([along, -np.sqrt(1 - along**2)])
        through = corner - back * speed * one.lateness(corner[None])[0]
        left, amplitude = np.array([-back[1], back[0]]), wave.amplitude / one.rock.density
        pulse = history_of(wave, share * amplitude / one.speed)
        found.append(PlaneWave(one.rock, back, back if k == 0 else left, speed, through, pulse))
    return found


LATER = {"time": {"duration": 0.03}, "record": {"points": [[10.0, 12.0], [9.0, 16.0]]}}


@pytest.mark.parametrize("kind, angle", [("P", 30.0), ("P", 60.0), ("S", 20.0)])
def test_a_quiet_side_sends_back_what_its_closed_form_says(kind, angle, struck):
    """The incident wave and what the formula has come back enter through the other sides; the top
    gets dashpots alone: of both together its tractions are none. What comes back is fitted."""
    a = np.radians(angle)
    scene = struck(kind, (np.sin(a), np.cos(a)), joints=[], **LATER)
    one = plane_wave(scene, scene.waves[0])
    # SV waves of the formula move to the right of their travel, those of scenes to the left.
    closed = np.real(coefficients("P" if kind == "P" else "SV", a, one.rock))
    closed = closed * (1 if kind == "P" else -1)
    back = sent_back(scene, closed)
    x, top = np.array(scene.record.points), np.array([[4.0, 20.0], [16.0, 20.0]])
    found = simulate(scene, incident=FreeField((one, *back)))
    t = found.time.values
    whole, Z = FreeField((one, *back))(top, t), (one.rock.s_impedance, one.rock.p_impedance)
    pulls = whole.stress[:, [2, 1]] + np.array(Z)[:, None] * whole.velocity
    assert np.abs(pulls).max() < 1e-9 * np.abs(whole.stress).max()
    own = found.velocity.values.swapaxes(1, 2) - one.motion(x, t).velocity
    unit = [wave.motion(x, t).velocity.ravel() for wave in sent_back(scene, (1.0, 1.0))]
    measured = np.linalg.lstsq(np.stack(unit, axis=1), own.ravel(), rcond=None)[0]
    assert measured == pytest.approx(closed, abs=1e-3)


def test_a_turned_scene_has_a_turned_result(struck):
    """By 40 degrees: sides that are not along the axes have dashpots that are not, either."""
    angle = np.radians(40.0)
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    plain = struck("P", dip=30.0)
    scene = turned(plain, turn)
    found, other = (simulate(s, incident=field_of(s)) for s in (plain, scene))
    size = np.abs(found.velocity).max()
    assert np.abs(found.velocity.values @ turn.T - other.velocity.values).max() < 1e-9 * size
    assert np.abs(found.gap - other.gap).max() < 1e-9 * np.abs(found.gap).max()
    assert np.abs(found.traction - other.traction).max() < 1e-9 * np.abs(found.traction).max()


SOFT = {"name": "soft", "dip": 20.0, "through": [10.0, 9.0], "density": 2200.0}
HARD = {"name": "hard", "dip": 20.0, "through": [10.0, 14.0], "intact_modulus": 8e10}


@pytest.mark.parametrize("kind", ["P", "S"])
def test_a_pulse_in_layers_is_the_exact_one(struck, kind):
    """Three rocks that dip by 20 degrees with a joint in the middle one: sides, receivers in each
    rock and on the joint, at 14 elements of order 2 a wavelength of the slowest wave."""
    scene = struck(
        kind,
        dip=20.0,
        regions=[SOFT | {"intact_modulus": 3e10}, HARD],
        record={"points": [[10.0, 4.0], [12.0, 13.0], [9.0, 17.0]], "joints": [[10.0, 10.0]]},
        continuum={"size": 0.8},
    )
    found, exact = simulate(scene, incident=field_of(scene)), solve("parallel-joints", scene)
    for name in ("velocity", "displacement", "stress", "traction", "gap", "slip"):
        assert relative_l2(found[name].values, exact[name].values) < 3e-3
    assert energy_residual(found) < 1e-11


@pytest.mark.parametrize("model", ["jointed", "equivalent"])
def test_a_column_of_two_rocks_is_pressed_as_both_in_series(rock_mass, model):
    """2 m by 6 m without a Poisson effect, at rest under 1 MPa: sigma h / E of each rock and four
    joints in the upper one, of which the lowest lies along the boundary, or their medium."""
    scene = rock_mass(
        {"dip": 0.0, "spacing": 0.5, "regions": ["upper"]},
        domain={"size": [2.0, 6.0]},
        rock={"density": 2600.0, "intact_modulus": 5e10, "intact_poisson": 0.0},
        regions=[{"name": "upper", "through": [0.0, 4.0], "intact_modulus": 2e10}],
        boundaries={"bottom": "fixed"},
        loads=[{"kind": "pressure", "side": "top", "shape": "step", "amplitude": 1e6}],
        damping={"mass_proportional": 500.0},
        continuum={"order": 2},
        time={"duration": 0.05},
        record={"points": [[1.0, 2.0], [1.0, 6.0]]},
    )
    moved = -simulate(scene, model).displacement.values[:, -1, 1]
    assert moved[0] == pytest.approx(1e6 * 2 / 5e10, rel=1e-4)
    assert moved[1] == pytest.approx(1e6 * (4 / 5e10 + 2 / 2e10 + 4 / 2e10), rel=1e-4)


def test_an_outline_of_the_same_rock_changes_nothing(struck):
    """A pentagon in rock that a P wave passes: the waves of one rock, in another mesh."""
    corners = [[6.0, 8.0], [12.0, 7.0], [15.0, 11.0], [11.0, 15.0], [7.0, 13.0]]
    tables = {"joints": [], "domain": {"size": [20.0, 20.0], "non_convex": "cut"}}
    tables["record"] = {"points": [[10.0, 10.0], [10.0, 17.0]]}
    plain = struck(**tables)
    lens = struck(**tables, regions=[{"name": "lens", "outline": corners, "density": 2600.0}])
    soft = struck(**tables, regions=[{"name": "lens", "outline": corners, "intact_modulus": 1e10}])
    one, other, third = (simulate(x, incident=field_of(x)) for x in (plain, lens, soft))
    exact = field_of(plain)(np.array(plain.record.points), one.time.values).velocity
    for found in (one, other):
        assert relative_l2(found.velocity.values.swapaxes(1, 2), exact) < 5e-3
    assert relative_l2(third.velocity.values, one.velocity.values) > 0.3
    assert energy_residual(third) < 1e-11
