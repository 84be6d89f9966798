"""One joint that stiffens or slips in a rock mass: its linear limit, the plane against space."""

import numpy as np
import pytest

from jointwave.cases.incident import plane_wave
from jointwave.cases.sampling import sample_times
from jointwave.compare.engines import applies, solve
from jointwave.compare.exact.rock_mass.field import field_of

CLOSES = {"maximum_closure": 1e-4}
#: Strength of 2e5 + 1e6 tan(30) Pa under `PRESSED`.
SLIPS = {"friction_angle": 30.0, "cohesion": 2e5}
PRESSED = {"xx": 1e6, "yy": 1e6}


@pytest.mark.parametrize(
    "law, kind, pressed, still, bound",
    [
        (SLIPS | {"cohesion": 2e6}, "S", PRESSED, "gap", 1e-8),
        ({"maximum_closure": 10.0}, "P", None, "slip", 2e-5),
    ],
)
def test_a_strong_joint_and_one_that_hardly_closes_are_linear(
    straight, law, kind, pressed, still, bound
):
    """The linear joint at an angle, by FFT, of an S wave of 1 MPa at twice that strength, and of a
    P wave at a maximum closure of 10 m, a million times what it closes: the curve bends by 1e-5."""
    found = solve("normal-incidence", straight(law, {"kind": kind}, pressed))
    linear = solve("oblique-joint", straight({}, {"kind": kind}, pressed))
    moves = {"gap": "slip", "slip": "gap"}[still]
    for name in ("velocity", "displacement", "stress", "traction", "gap", "slip"):
        one, other = found[name].values, linear[name].values
        size = np.abs(linear[moves if name == still else name].values).max()
        assert np.abs(one - other).max() <= bound * size, name


@pytest.mark.parametrize(
    "law, kind",
    [(SLIPS | {"shear_stiffness": 1e14}, "S"), (CLOSES | {"normal_stiffness": 1e14}, "P")],
)
def test_a_joint_too_stiff_to_integrate_is_refused_at_once(straight, law, kind):
    """It took ten minutes and more, also before a run of an engine."""
    answer = applies("normal-incidence", straight(law, {"kind": kind}, PRESSED))
    assert "too stiff: the scene lasts" in answer.reason


def marched_in_time(scene, times):
    """Return normal stress, shear stress and slip of the one joint of a scene over time, Pa and m,
    by Euler's steps of 1e-6 s: in each the jumps grow by what the waves do not pass, and the shear
    stress beyond the strength slips."""
    law, fine = scene.joint_sets[0], np.arange(0.0, times[-1] + 1e-6, 1e-6)
    by_kind, place = {}, np.array(scene.record.joints)
    for one in scene.waves:
        wave = plane_wave(scene, one)
        Z = float(wave.rock.density) * wave.speed
        by_kind[one.kind] = wave, Z, Z * wave.pulse.value(fine - wave.lateness(place)[0])
    (p_wave, Z_p, pressing), (s_wave, Z_s, shearing) = by_kind["P"], by_kind["S"]
    traction = scene.prestress.tensor @ p_wave.direction
    normal, shear = p_wave.direction @ traction, s_wave.polarisation @ traction
    static, dynamic = np.tan(np.radians([law.friction_angle, law.dynamic_friction_angle or 0.0]))
    p, carried, slip, path, found = 0.0, shear, 0.0, 0.0, []
    for incident_p, incident_s in zip(pressing, shearing, strict=True):
        found.append((normal + p, carried, slip))
        p += 1e-6 * 2 * law.normal_stiffness / Z_p * (incident_p - p)
        moves = 1e-6 * 2 / Z_s * (incident_s + shear - carried)
        carried, slip = carried + law.shear_stiffness * moves, slip + moves
        friction, cohesion = static, law.cohesion or 0.0
        if law.weakening_distance:
            friction -= (static - dynamic) * min(path / law.weakening_distance, 1.0)
        if path and law.residual_cohesion is not None:
            cohesion = law.residual_cohesion
        strength = cohesion + friction * (normal + p)
        if abs(carried) > strength:
            if law.residual_cohesion is not None:
                strength += law.residual_cohesion - cohesion
            path += (abs(carried) - strength) / law.shear_stiffness
            carried = np.copysign(strength, carried)
    return np.array([np.interp(times, fine, one) for one in np.transpose(found)])


WEAKENS = {"friction_angle": 30.0, "dynamic_friction_angle": 18.0, "weakening_distance": 5e-4}
LOSES = {"friction_angle": 20.0, "cohesion": 3e5, "residual_cohesion": 5e4}


@pytest.mark.parametrize(
    ("law", "sheared", "up"),
    [(WEAKENS, 1.5e6, 1), (LOSES, -0.4e6, 1), (LOSES, -0.4e6, -1), (SLIPS, 0.0, -1)],
)
def test_a_sheared_joint_slips_under_both_waves_as_it_does_marched_in_time(
    rock_mass, joint, wave, law, sheared, up
):
    """In a step of 1e-6 s a wave of 1 MPa and 200 Hz changes by omega dt = 1.3e-3 of itself; what
    breaks at once, cohesion of .25 MPa, does so a step late: in one sample of 600."""
    n = np.array([-np.sin(np.radians(25.0)), np.cos(np.radians(25.0))])
    t = np.array([n[1], -n[0]])
    stress = 3e6 * np.eye(2) + sheared * (np.outer(n, t) + np.outer(t, n))
    both = {"direction": (up * n).tolist(), "through": [16.0, 15.0 - 21.0 * up]}
    scene = rock_mass(
        joint_sets=[joint(**law)],
        waves=[wave(**both, kind="S"), wave(**both, kind="P", amplitude=-8e5)],
        prestress=dict(zip(("xx", "yy", "xy"), stress[[0, 1, 0], [0, 1, 1]].tolist(), strict=True)),
    )
    assert applies("normal-incidence", scene)
    found = solve("normal-incidence", scene)
    normal, shear, slip = marched_in_time(scene, found.time.values)
    traction, sign = found.traction.values[0], np.sign(found.slip.values[0] @ slip)
    assert np.abs(normal - traction[:, 0]).max() <= 2e-3 * 8e5
    assert np.sort(np.abs(np.abs(shear) - np.abs(traction[:, 1])))[-2] <= 5e-3 * 1e6
    assert np.abs(slip).max() > 1e-4
    assert np.abs(found.slip.values[0] - sign * slip).max() <= 5e-3 * np.abs(slip).max()


def test_space_turned_about_the_normal_is_the_plane(straight, rock_mass, joint, wave):
    """A wave that goes up through a horizontal joint, and moves rock along (0.6, 0.8): what the
    plane has along x, with friction that weakens."""
    law = SLIPS | {"dynamic_friction_angle": 20.0, "weakening_distance": 1e-3, "dip": 0.0}
    flat = rock_mass(joint_sets=[joint(**law)], waves=[wave(kind="S")], prestress=PRESSED)
    space = rock_mass(
        domain={"size": [40.0, 40.0, 30.0]},
        joint_sets=[joint(**law | {"through": [20.0, 20.0, 15.0]})],
        waves=[wave(kind="S", direction=[0.0, 0.0, 1.0], polarisation=[-0.6, -0.8, 0.0])],
        boundaries=dict.fromkeys(("front", "back"), "quiet"),
        prestress=PRESSED | {"zz": 1e6},
        record={"points": [[18.0, 3.0, 4.0], [22.0, 9.0, 27.0]], "joints": [[20.0, 9.0, 15.0]]},
    )
    one, other = (solve("normal-incidence", scene) for scene in (flat, space))
    axis = np.array([0.6, 0.8])
    assert np.abs(one.slip).max() > 3e-5
    for name in ("velocity", "displacement"):
        along = other[name].values[..., :2] @ axis
        assert along == pytest.approx(one[name].values[..., 0], abs=1e-12), name
    size = np.linalg.norm(other.slip, axis=-1)
    assert size == pytest.approx(np.abs(one.slip.values), abs=1e-12)


@pytest.mark.parametrize("law, kind, pressed", [(CLOSES, "P", None), (SLIPS, "S", PRESSED)])
def test_what_enters_is_the_solution(straight, law, kind, pressed):
    """Through quiet sides, at the place of the receivers."""
    scene = straight(law, {"kind": kind}, pressed)
    field, found = field_of(scene), solve("normal-incidence", scene)
    velocity, stress = field(np.array(scene.record.points), sample_times(scene))
    assert np.abs(velocity - found.velocity.values.swapaxes(1, 2)).max() <= 1e-12
    carried = found.stress.values - np.array([1e6, 1e6, 0.0]) * (pressed is not None)
    assert np.abs(stress + carried.swapaxes(1, 2)).max() <= 1e-6
    gap = found.gap.values[0]
    assert kind == "S" or found.traction.values[0, :, 0] == pytest.approx(
        1e10 * gap / -(1 + np.minimum(gap / 1e-4, 0)), abs=1.0
    )
