"""Scenes of plane waves at joints: closed forms, balance, turned scenes, bounds of errors."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from closed_forms.one_joint import relaxed_sine
from jointwave.compare.engines import applies, solve
from jointwave.compare.exact.plane.oblique_joint import Joint
from jointwave.compare.exact.rock_mass.stack import stack_of


@pytest.mark.parametrize("zeta", [0.0, 0.05])
def test_normal_incidence_in_closed_form(rock_mass, joint, wave, zeta):
    """Z = 2500 a, a = sqrt(2.4e7) m/s. A dashpot of eta = 2 zeta sqrt(2500 x 15 / 1e10) s passes
    eta/tau at once and the rest with tau = eta + Z/2K as s, tau s' + s = sigma_I. The pulse starts
    at the bottom and meets the joint 15 m above it."""
    K, a, T = 1e10, np.sqrt(2.4e7), 0.005
    Z, eta = 2500 * a, 2 * zeta * np.sqrt(2500 * 15 / K)
    tau, w = eta + Z / (2 * K), 2 * np.pi / T

    def came(t):
        return np.where((t > 0) & (t < T), np.sin(w * t), 0.0)

    def passed(t):
        return 1e6 * (eta / tau * came(t) + (1 - eta / tau) * relaxed_sine(t, w, T, tau))

    flat = joint(dip=0.0, damping_ratio=zeta)
    found = solve("oblique-joint", rock_mass(joint_sets=[flat], waves=[wave(shape="sine")]))
    t = found.time.values
    expected = passed(t - 27 / a)
    assert rms(found.velocity[1, :, 1] - expected / Z) <= found.velocity_error[1, 1] < 1e-5 / 12
    assert rms(found.stress[1, :, 1] - expected) <= found.stress_error[1, 1] < 100
    assert rms(found.stress[1, :, 0] - expected / 3) <= found.stress_error[1, 0]
    there = passed(t - 15 / a)
    assert rms(found.traction[0, :, 0] - there) <= found.traction_error[0, 0] < 100
    front = 1e6 * (came(t - 4 / a) + came(t - 26 / a)) - passed(t - 26 / a)
    back = 1e6 * (came(t - 4 / a) - came(t - 26 / a)) + passed(t - 26 / a)
    assert rms(found.velocity[0, :, 1] - front / Z) <= found.velocity_error[0, 1]
    assert rms(found.stress[0, :, 1] - back) <= found.stress_error[0, 1]
    assert np.abs(found.velocity[..., 0]).max() < 1e-9
    arrived = 1e6 * came(t - 15 / a)
    gap = -(there / K + eta * 2 * (there - arrived) / Z)
    assert rms(found.gap[0] - gap) <= found.gap_error[0]


def rms(values):
    return float(np.sqrt(np.mean(np.asarray(values) ** 2)))


OBLIQUE = {"direction": [0.28, 0.96]}


def test_displacement_is_the_integral_of_velocity_and_springs_hold(rock_mass, wave):
    """Simpson's rule at 400 samples a period is off by (omega h)^4 / 180 of it, 2e-8 / 180 at twice
    the dominant frequency; without dashpots gap and slip are tractions over stiffnesses."""
    scene = rock_mass(waves=[wave(**OBLIQUE)], record={"interval": 1.25e-5})
    found = solve("oblique-joint", scene)
    v = found.velocity.values
    pairs = 1.25e-5 / 3 * (v[:, :-2:2] + 4 * v[:, 1:-1:2] + v[:, 2::2])
    integral, peak = np.cumsum(pairs, axis=1), np.abs(found.displacement.values).max()
    assert np.abs(found.displacement.values[:, 2::2] - integral).max() < 1e-7 * peak
    assert found.displacement_error.max() < 1e-9 * peak
    for k, (name, K) in enumerate((("gap", 1e10), ("slip", 4e9))):
        off = found[name] + found.traction[..., k] / K
        bound = found[f"{name}_error"] + found.traction_error[..., k] / K
        assert rms(off[0]) <= bound[0] < 1e-8 * np.abs(found[name]).max()


@pytest.mark.parametrize("zeta", [0.0, 0.05])
def test_energy_flows_through_and_dashpots_take_their_part(rock_mass, joint, wave, zeta):
    """The work that a pulse carries across lines along the joint, int -n.sigma.v dt per metre, is
    the same on both sides, less int eta K (rate)^2 dt of the joint's normal and shear dashpots;
    rates by differences of fourth order."""
    damped = joint(damping_ratio=zeta)
    h, s, c = 2e-5, np.sin(np.radians(25)), np.cos(np.radians(25))
    scene = rock_mass(
        joint_sets=[damped],
        waves=[wave(**OBLIQUE)],
        record={"interval": h},
        time={"duration": 0.04},
    )
    found, n = solve("oblique-joint", scene), np.array([-s, c])
    xx, yy, xy = np.moveaxis(found.stress.values, 2, 0)
    pressed = np.stack([xx * n[0] + xy * n[1], xy * n[0] + yy * n[1]], axis=2)
    before, behind = (pressed * found.velocity.values).sum(axis=(1, 2)) * h
    lost, extent = 0.0, 40 * s + 30 * c
    eta = 2 * zeta * np.sqrt(2500 * extent / 2 / 1e10)
    for name, K in (("gap", 1e10), ("slip", 4e9)):
        x = found[name].values[0]
        rate = (8 * (x[3:-1] - x[1:-3]) - (x[4:] - x[:-4])) / (12 * h)
        lost += eta * K * (rate**2).sum() * h
    assert before - behind == pytest.approx(lost, abs=1e-6 * before)
    assert (lost > 0.01 * before) == bool(zeta)


def test_a_turned_scene_has_turned_results(rock_mass, joint, wave):
    """A quarter turn to the left about the origin takes (x, y) to (-y, x)."""
    records = {"points": [[18.0, 4.0]], "joints": [[20.0, 15.0]]}
    tables = {"waves": [wave(**OBLIQUE, kind="S", through=[0.0, -20.0])]}
    one = solve("oblique-joint", rock_mass(**tables, record=records))
    outline = [[0, 0], [0, 40], [-30, 40], [-30, 0]]
    turned = {
        "domain": {"size": None, "outline": outline},
        "joint_sets": [joint(dip=115.0, through=[-15.0, 20.0])],
        "waves": [wave(direction=[-0.96, 0.28], kind="S", through=[20.0, 0.0])],
        "record": {"points": [[-4.0, 18.0]], "joints": [[-15.0, 20.0]]},
    }
    other = solve("oblique-joint", rock_mass(**turned))
    axes = dict.fromkeys(("velocity", "displacement"), ([1, 0], [-1, 1]))
    axes |= {"stress": ([1, 0, 2], [1, 1, -1])}
    axes |= dict.fromkeys(("traction", "gap", "slip"), (slice(None), 1))
    for name, (order, signs) in axes.items():
        off = other[name].values - one[name].values[..., order] * signs
        assert np.abs(off).max() < 1e-9 * np.abs(one[name]).max()


def test_waves_superpose_and_prestress_adds_to_stresses(rock_mass, wave):
    """sigma_xx = 1, sigma_yy = 3, sigma_xy = -0.5 MPa press on the joint of normal n and tangent t
    with n sigma n and t sigma n."""
    up, across = wave(**OBLIQUE), wave(direction=[-0.6, 0.8], through=[40.0, -10.0], amplitude=3e5)
    parts = [solve("oblique-joint", rock_mass(waves=[one])) for one in (up, across)]
    stress = {"xx": 1e6, "yy": 3e6, "xy": -5e5}
    both = solve("oblique-joint", rock_mass(waves=[up, across], prestress=stress))
    s, c = np.sin(np.radians(25)), np.cos(np.radians(25))
    n, t, tensor = [-s, c], [-c, -s], np.array([[1e6, -5e5], [-5e5, 3e6]])
    still = {"stress": [1e6, 3e6, -5e5], "traction": [n @ tensor @ n, t @ tensor @ n]}
    for name in ("velocity", "displacement", "stress", "traction", "gap", "slip"):
        expected = parts[0][name] + parts[1][name] + still.get(name, 0.0)
        assert np.abs(both[name] - expected).max() <= 1e-12 * np.abs(expected).max()
        bound = parts[0][f"{name}_error"] + parts[1][f"{name}_error"]
        assert both[f"{name}_error"].values == pytest.approx(bound.values, rel=1e-9)


def test_a_point_on_a_joint_moves_as_the_mean_of_its_sides(rock_mass):
    """The displacements on both sides differ by gap and slip along the axes of the joint."""
    normal = np.array([-np.sin(np.radians(25)), np.cos(np.radians(25))])
    points = [np.array([20.0, 15.0]) + side * normal for side in (0.0, -1e-6, 1e-6)]
    found = solve("oblique-joint", rock_mass(record={"points": [p.tolist() for p in points]}))
    on, below, above = found.displacement.values
    size = np.abs(on).max()
    assert np.abs(on - (below + above) / 2).max() < 1e-5 * size < np.abs(on - above).max()
    axes = np.array([normal, [-normal[1], normal[0]]])
    jump = np.stack([found.gap[0], found.slip[0]], axis=1)
    assert np.abs((above - below) @ axes.T - jump).max() < 1e-5 * size


def test_unlike_sets_and_scattered_spacings_are_met_where_they_are(rock_mass, joint, wave):
    """Joints of 1e10 Pa/m every 7 m from x = 0, y = 2 and one of 3e9 Pa/m between two of them, as
    the wave meets them; a scattered set has the offsets of the blocks' contacts."""
    soft = joint(name="soft", normal_stiffness=3e9, shear_stiffness=2e9)
    sets = [joint(dip=10.0, spacing=7.0, through=[0.0, 2.0]), soft | {"dip": -170.0}]
    scene = rock_mass(joint_sets=sets, waves=[wave(direction=[0.28, 0.96])])
    s, c = np.sin(np.radians(10)), np.cos(np.radians(10))
    stiff = 2 * c + 7 * np.arange(-1, 4)
    offsets = np.sort([*stiff, 15 * c - 20 * s])
    laws = [Joint(1e10, 4e9) if x in stiff else Joint(3e9, 2e9) for x in offsets]
    stack = stack_of(scene)
    assert stack.offsets == pytest.approx(offsets, abs=1e-12) and stack.joints == laws
    scattered = rock_mass(joint_sets=[joint(dip=10.0, spacing=7.0, scatter=0.2, seed=3)])
    apart = np.diff(stack_of(scattered).offsets)
    assert (apart > 0).all() and np.ptp(apart) > 0.1 and applies("parallel-joints", scattered)


@settings(max_examples=5, derandomize=True)
@given(
    dip=st.floats(-60, 60),
    spacing=st.floats(6, 12),
    zeta=st.sampled_from([0.0, 0.05]),
    angle=st.floats(-20, 20),
    shape=st.sampled_from(["ricker", "sine"]),
    kind=st.sampled_from("PS"),
)
def test_errors_are_bounded(rock_mass, joint, wave, dip, spacing, zeta, angle, shape, kind):
    """The difference from inversions with four times the samples is within the sum of bounds."""
    travel = np.radians(dip + 90 + angle)
    direction = np.array([np.cos(travel), np.sin(travel)])
    begin = np.array([20.0, 15.0]) - 40 * direction
    tables = {
        "joint_sets": [joint(dip=dip, spacing=spacing, damping_ratio=zeta)],
        "waves": [wave(shape=shape, kind=kind, direction=[*direction], through=[*begin])],
        "time": {"duration": 0.02},
    }
    one, other = (
        solve("parallel-joints", rock_mass(**tables, record={"interval": h})) for h in (4e-5, 1e-5)
    )
    for name in ("velocity", "displacement", "stress", "traction", "gap", "slip"):
        off = one[name] - other[name].isel(time=slice(None, None, 4))
        off = np.sqrt((off**2).mean("time"))
        assert (off <= one[f"{name}_error"] + other[f"{name}_error"]).all()
