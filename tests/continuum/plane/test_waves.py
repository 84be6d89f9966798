"""Waves in rock masses against exact solutions of the same scenes."""

import numpy as np
import pytest

from closed_forms.quiet_face import coefficients
from jointwave.cases.incident import FreeField, PlaneWave, plane_wave
from jointwave.cases.loads import history_of
from jointwave.compare.exact.rock_mass.field import field_of
from jointwave.compare.exact.rock_mass.stack_waves import ONE_JOINT
from jointwave.continuum import simulate
from tests.continuum.plane.conftest import ROCK


def misfit(found, exact):
    """Return the relative L2 misfit over time and components of each receiver."""
    off, size = (np.linalg.norm(x, axis=tuple(range(1, x.ndim))) for x in (found - exact, exact))
    return off / size


def gap_of_ledger(result):
    """Return what the terms of the ledger are off by at most, over the largest of them."""
    energy = result.energy.values
    return np.abs(energy[:-1].sum(axis=0) - energy[-1]).max() / np.abs(energy).max()


@pytest.mark.parametrize("kind, dip", [("P", 0.0), ("S", 0.0), ("P", 30.0), ("S", 30.0)])
def test_a_pulse_at_one_joint_is_the_exact_one(kind, dip, struck):
    """At 11 elements a wavelength of S waves, of order 2, with the exact field at all sides."""
    scene = struck(kind, dip=dip)
    found, exact = simulate(scene, incident=field_of(scene)), ONE_JOINT.run(scene)
    opens, slips = (np.abs(exact[name]).max() for name in ("gap", "slip"))
    names = [name for name, by in (("gap", opens), ("slip", slips)) if by > 1e-6 * (opens + slips)]
    for name in ("velocity", "displacement", "stress", "traction", *names):
        assert misfit(found[name].values, exact[name].values).max() < 2e-3
    assert gap_of_ledger(found) < 1e-11


def test_a_joint_is_read_by_one_element_as_wide_as_the_period(struck):
    """Both ends of its facet are one node."""
    sides = dict.fromkeys(("left", "right"), "periodic") | dict.fromkeys(("bottom", "top"), "quiet")
    record = {"points": [[2.0, 5.0]], "joints": [[2.0, 10.0], [4.9, 10.0]]}
    tables = {"domain": {"size": [5.0, 20.0]}, "boundaries": sides, "record": record}
    joints = [{"dip": 0.0, "through": [2.0, 10.0]}]
    scene = struck("P", joints=joints, continuum={"size": 5.0, "order": 4}, **tables)
    found, exact = simulate(scene, incident=field_of(scene)), ONE_JOINT.run(scene)
    for name in ("traction", "gap"):
        assert misfit(found[name].values, exact[name].values).max() < 2e-3


def sent_back(scene, shares):
    """Return the P and SV wave that the top sends back of the wave of a scene, in time with it, of
    these shares of its amplitude."""
    (wave,) = scene.waves
    one, found = plane_wave(scene, wave), []
    corner = np.array([0.0, 20.0])
    for k, (speed, share) in enumerate(
        zip((one.rock.p_speed, one.rock.s_speed), shares, strict=True)
    ):
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


def test_its_error_falls_with_the_third_power_of_the_size(struck):
    """Order 2: h^3 of displacements and velocities, where steps are as small as they have to be:
    their error falls as their square, and they are halved with the size."""
    off = []
    for size in (2.5, 1.25):
        scene = struck(continuum={"size": size, "step_fraction": 0.3})
        found, exact = simulate(scene, incident=field_of(scene)), ONE_JOINT.run(scene)
        off.append(misfit(found.velocity.values, exact.velocity.values).max())
    assert 2.6 < np.log2(off[0] / off[1]) < 4.2


def test_a_turned_scene_has_a_turned_result(struck):
    """By 40 degrees: sides that are not along the axes have dashpots that are not, either."""
    angle = np.radians(40.0)
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])

    def turned(points):
        return (np.array(points) @ turn.T).tolist()

    plain = struck("P", dip=30.0)
    corners = plain.domain.corners
    scene = struck(
        direction=turned([0.0, 1.0]),
        through=turned([0.0, -4.0]),
        domain={"outline": turned(corners)},
        joints=[{"dip": 70.0, "through": turned([10.0, 10.0])}],
        boundaries={"outline": "quiet"},
        record={key: turned(getattr(plain.record, key)) for key in ("points", "joints")},
    )
    found, other = (simulate(s, incident=field_of(s)) for s in (plain, scene))
    size = np.abs(found.velocity).max()
    assert np.abs(found.velocity.values @ turn.T - other.velocity.values).max() < 1e-9 * size
    assert np.abs(found.gap - other.gap).max() < 1e-9 * np.abs(found.gap).max()
    assert np.abs(found.traction - other.traction).max() < 1e-9 * np.abs(found.traction).max()


def test_implicit_steps_balance_dashpots_beside_a_prestress(rock_mass):
    """Before a wave comes, round-off of the prestress is all that is out of balance.
    Held to explicit steps: a phase error of (omega dt)^2 / 12 a radian, 7e-4 after 8 of them at 200
    steps a period, several times that at the highest frequencies of the pulse."""
    joint = {"dip": 30.0, "through": [3.0, 3.0], "friction_angle": 35.0, "damping_ratio": 0.05}
    pulse = {"shape": "ricker", "amplitude": 1e5, "period": 2e-3}
    found = [
        simulate(
            rock_mass(
                joint,
                rock=ROCK,
                domain={"size": [6.0, 6.0]},
                continuum={"scheme": scheme, "order": 2},
                prestress={"xx": 8e6, "yy": 1e7, "xy": 0.0},
                waves=[{"kind": "S", "direction": [0.0, 1.0], "through": [3.0, -6.0], **pulse}],
                boundaries=dict.fromkeys(("left", "right", "bottom", "top"), "quiet"),
                time={"duration": 6e-3},
            )
        )
        for scheme in ("implicit", "explicit")
    ]
    implicit, explicit = (one.velocity.values for one in found)
    assert misfit(implicit, explicit).max() < 1e-2
