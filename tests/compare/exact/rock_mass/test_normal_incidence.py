"""One joint that stiffens or slips in a rock mass: its linear limit, the plane against space, where
it holds."""

import numpy as np
import pytest
from scipy.integrate import cumulative_trapezoid

from closed_forms.slipping_joint import slipping_joint
from jointwave.cases.incident import plane_wave
from jointwave.cases.sampling import sample_times
from jointwave.compare.engines import applies, solve
from jointwave.compare.exact.rock_mass.field import field_of

CLOSES = {"maximum_closure": 1e-4}
#: Strength of 2e5 + 1e6 tan(30) Pa under `PRESSED`.
SLIPS = {"friction_angle": 30.0, "cohesion": 2e5}
PRESSED = {"xx": 1e6, "yy": 1e6}
ALONE = "the wave is not one at normal incidence"
NO = [
    ({}, {}, {}, "no joint has closure or can slip: see oblique-joint"),
    (CLOSES | {"damping_ratio": 0.1}, {}, {}, "the joint is damped"),
    (CLOSES | {"friction_angle": 30.0}, {}, {}, "joint set 'joint' can slip"),
    (CLOSES, {"direction": [0.0, 1.0]}, {}, ALONE),
    (CLOSES, {"kind": "S"}, {}, "the joint cannot slip under an S wave: see oblique-joint"),
    (SLIPS, {"kind": "S", "direction": [0.0, 1.0]}, PRESSED, ALONE),
    (SLIPS | {"residual_cohesion": 0.0}, {"kind": "S"}, PRESSED, "the joint loses cohesion"),
    (SLIPS, {"kind": "S"}, PRESSED | {"xx": 2e6}, "the prestress shears the joint"),
    (SLIPS, {"kind": "S"}, {"xx": -1e5, "yy": -1e5}, "no normal stress closes the joint"),
    (SLIPS | {"tension": False}, {"kind": "S"}, {}, "no normal stress closes the joint"),
    (
        SLIPS | {"dynamic_friction_angle": 10.0, "weakening_distance": 1e-5},
        {"kind": "S"},
        PRESSED,
        "friction falls with slip faster than the joint unloads",
    ),
    (
        SLIPS | {"dilation_angle": 5.0, "dilation_distance": 1e-3},
        {"kind": "S"},
        PRESSED,
        "joint set 'joint': a joint dilates as it slips",
    ),
]


@pytest.fixture
def straight(rock_mass, joint, wave):
    """A function of keys of the joint and of the wave, which meets the joint straight on at an
    angle to the axes."""
    n = [-np.sin(np.radians(25.0)), np.cos(np.radians(25.0))]
    whole = {"direction": n, "through": [16.0, -6.0]}
    return lambda law, one, pressed=None: rock_mass(
        joint_sets=[joint(**law)],
        waves=[wave(**whole | one)],
        **({"prestress": pressed} if pressed else {}),
    )


@pytest.mark.parametrize("law, one, pressed, reason", NO)
def test_no_gives_the_reason(straight, law, one, pressed, reason):
    assert applies("normal-incidence", straight(law, one, pressed)).reason == reason


def test_a_joint_that_is_strong_enough_is_linear(straight):
    """Under an S wave of 1 MPa and twice that strength: the linear joint at an angle, by FFT."""
    slow = {"kind": "S", "through": [16.0, -6.0]}
    found = solve("normal-incidence", straight(SLIPS | {"cohesion": 2e6}, slow, PRESSED))
    linear = solve("oblique-joint", straight({}, slow, PRESSED))
    for name in ("velocity", "displacement", "stress", "traction", "gap", "slip"):
        one, other = found[name].values, linear[name].values
        size = np.abs(linear["slip" if name == "gap" else name].values).max()
        assert np.abs(one - other).max() <= 1e-8 * size, name


def test_a_stiff_joint_passes_what_it_can_carry(straight):
    """Rigid before it slips, s = sigma_I clipped at the strength, and the slip rate is
    2 (sigma_I - s) / Z: a joint of 1e12 Pa/m follows the wave by Z / 2 K = 3.5e-6 s, of which
    omega = 1257 / s, and twice that where it bends most, makes 0.9 %."""
    tau = 2e5 + 1e6 * np.tan(np.radians(30.0))
    scene = straight(SLIPS | {"shear_stiffness": 1e12}, {"kind": "S"}, PRESSED)
    found = solve("normal-incidence", scene)
    wave, place = plane_wave(scene, scene.waves[0]), np.array(scene.record.joints)
    impedance = float(wave.rock.density) * wave.speed
    incident = impedance * wave.pulse.value(found.time.values - wave.lateness(place)[0])
    carried = np.clip(incident, -tau, tau)
    shear = found.traction.values[0, :, 1]
    assert np.abs(np.abs(shear) - np.abs(carried)).max() <= 0.9e-2 * 1e6
    slip = cumulative_trapezoid(2 * (incident - carried) / impedance, found.time, initial=0)
    assert np.abs(slip).max() > 3e-5
    slip += carried / 1e12
    sign = np.sign(found.slip.values[0, -1] * slip[-1])
    assert np.abs(found.slip.values[0] - sign * slip).max() <= 1.5e-2 * np.abs(slip).max()


def test_a_joint_that_slips_moves_as_it_does_marched_in_time(straight):
    """By Heun's method in steps of 4e-6 s, for waves at any angle; it has the wave reach its
    strength up to a step late, which changes velocity by a part omega dt = 5e-3 there."""
    scene = straight({"friction_angle": 0.0, "cohesion": 4e5}, {"kind": "S"})
    found, points = solve("normal-incidence", scene), np.array(scene.record.points)
    marched = slipping_joint(scene, points, found.time.values)
    assert np.abs(found.slip).max() > 1e-4
    size = np.abs(marched).max()
    assert np.abs(found.velocity.values - marched).max() <= 5e-3 * size


def test_space_turned_about_the_normal_is_the_plane(straight, rock_mass, joint, wave):
    """A wave that goes up through a horizontal joint, and moves rock along (0.6, 0.8): what the
    plane has along x, with friction that weakens."""
    law = SLIPS | {"dynamic_friction_angle": 20.0, "weakening_distance": 1e-3, "dip": 0.0}
    flat = rock_mass(
        joint_sets=[joint(**law)],
        waves=[wave(kind="S")],
        prestress=PRESSED,
    )
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
    size = np.linalg.norm(other.slip.values, axis=-1)
    assert size == pytest.approx(np.abs(one.slip.values), abs=1e-12)


def test_a_joint_that_hardly_closes_is_linear(straight):
    """At a maximum closure of 10 m, a million times what the wave closes, the curve bends by 1e-5
    and less: every waveform of the linear joint at an angle, by FFT."""
    found = solve("normal-incidence", straight({"maximum_closure": 10.0}, {}))
    linear = solve("oblique-joint", straight({}, {}))
    for name in ("velocity", "displacement", "stress", "traction", "gap", "slip"):
        one, other = found[name].values, linear[name].values
        size = np.abs(linear["gap" if name == "slip" else name].values).max()
        assert np.abs(one - other).max() <= 2e-5 * size, name


@pytest.mark.parametrize("law, kind, pressed", [(CLOSES, "P", None), (SLIPS, "S", PRESSED)])
def test_what_enters_is_the_solution(straight, law, kind, pressed):
    """Through quiet sides, at the place of the receivers."""
    scene = straight(law, {"kind": kind}, pressed)
    assert applies("normal-incidence", scene)
    field, found = field_of(scene), solve("normal-incidence", scene)
    velocity, stress = field(np.array(scene.record.points), sample_times(scene))
    assert np.abs(velocity - found.velocity.values.swapaxes(1, 2)).max() <= 1e-12
    carried = found.stress.values - np.array([1e6, 1e6, 0.0]) * (pressed is not None)
    assert np.abs(stress + carried.swapaxes(1, 2)).max() <= 1e-6
    gap = found.gap.values[0]
    assert kind == "S" or found.traction.values[0, :, 0] == pytest.approx(
        1e10 * gap / -(1 + np.minimum(gap / 1e-4, 0)), abs=1.0
    )
