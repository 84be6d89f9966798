"""Exact solutions of two cubes and of their bar, each value worked out by hand.

Cubes of 1 m and 1000 kg, E_eq = 2.5 MPa: k = 2.5e6 N/m between rigid blocks, c = 50 m/s and
Z = 5e4 Pa s/m in the bar. A step load of 1000 Pa.
"""

from math import cos, exp, pi, sin, sqrt

import numpy as np
import pytest

from closed_forms import beam, column, parallel_joints, thin_layer
from closed_forms.leapfrog import frequencies
from closed_forms.modes import modes
from closed_forms.spall import advance
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.schema.scene import Scene
from jointwave.compare.exact.bar import images
from jointwave.compare.exact.bar.bars import EQUIVALENT, JOINTED
from jointwave.compare.exact.bar.modes import SERIES
from jointwave.compare.exact.blocks import row_of_blocks, sliding_block
from jointwave.compare.exact.blocks.pillar import system_of
from jointwave.compare.exact.blocks.row_of_blocks import contact_forces
from jointwave.compare.exact.conditions import drive, joints_are_damped
from jointwave.compare.exact.joint import one_joint

PERIOD = 2 * pi / sqrt(5000.0)  # of the two blocks against each other, s
RECORD = {"stress": [0.0, 0.5, 1.0, 2.0], "velocity": [0.5, 1.5]}


def scene(duration=1.25 * PERIOD, samples=6, **tables):
    """Return the two cubes, with tables put in place of their own."""
    own = {
        "title": "by hand",
        "pillar": {"length": 2.0, "side": 1.0, "block": 1.0},
        "rock": {"density": 1000.0, "equivalent_modulus": 2.5e6, "equivalent_poisson": 0.25},
        "load": {"shape": "step", "amplitude": 1000.0},
        "time": {"duration": duration},
        "record": RECORD | {"interval": duration / (samples - 1)},
    }
    return Scene.model_validate(own | tables)


def holds(values, expected, rel=1e-10):
    """Hold an array to numbers, relative to the largest of them."""
    expected = np.array(expected, dtype=float)
    np.testing.assert_allclose(values, expected, rtol=0, atol=rel * np.abs(expected).max())


def along(variable):
    """Return the component along the pillar, [receiver, sample]."""
    return variable.sel(axis="y").values


def test_two_blocks_under_a_step():
    """F / 2 (1 - cos w t) in the joint, F t / 2m of both together, w^2 = 2 k / m = 5000 / s2."""
    found = row_of_blocks.solve(scene())
    t = np.arange(6) * PERIOD / 4
    one = np.array([1 - cos(n * pi / 2) for n in range(6)])
    ends = [1000.0 if n else 500.0 for n in range(6)]
    holds(found.stress, [ends, (ends + 500 * one) / 2, 500 * one, 0 * t])
    apart = np.array([sin(n * pi / 2) for n in range(6)]) * 500 / sqrt(5000.0) / 1000
    holds(along(found.velocity), [t / 2 + apart, t / 2 - apart])
    shift = 500 * one / 2.5e6 / 2
    holds(along(found.displacement), [t**2 / 4 + shift, t**2 / 4 - shift])


def test_two_blocks_apart_in_a_dashpot():
    """eta = 2 / w: the joint is critically damped, k g + c g' = F / 2 (1 - (1 - w t) e^-wt)."""
    w = sqrt(5000.0)
    ratio = 2 / w * sqrt(2500.0) / 2  # zeta of m and k gives 2 zeta sqrt(m / k)
    found = row_of_blocks.solve(scene(joints={"damping_ratio": ratio}))
    x = w * np.arange(6) * PERIOD / 4
    holds(found.stress.sel(stress_y=1.0), 500 * (1 - (1 - x) * np.exp(-x)))


def test_mass_damping_of_a_lone_motion():
    """Both ends free: the mean velocity goes to F / (2 m alpha) with alpha."""
    found = row_of_blocks.solve(scene(damping={"mass_proportional": 20.0}))
    t = np.arange(6) * PERIOD / 4
    holds(along(found.velocity).mean(axis=0), 1000 / 2000 / 20 * (1 - np.exp(-20 * t)))


def test_static_gravity_and_prestress_of_blocks_that_hang():
    """Free above, fixed below, 10 m/s2: 1e4 N on the joint, 2e4 N on the base, 300 Pa on all."""
    found = row_of_blocks.solve(
        scene(
            load={"shape": "step", "amplitude": 0.0},
            gravity={"direction": [0.0, 1.0, 0.0], "acceleration": 10.0},
            prestress={"normal": 300.0},
            ends={"end": "fixed"},
        )
    )
    holds(found.stress, np.outer([300, 5300, 10300, 20300], np.ones(6)))
    assert np.abs(along(found.velocity)).max() < 1e-12


def state_of(one, displacement, velocity):
    """Return the state of a chain's two blocks in motion (m, m/s), its faces at rest."""
    state = np.zeros(len(one.load))
    state[:2] = displacement / one.displacement.diagonal()
    state[2:4] = velocity / one.velocity.diagonal(2)
    return state


def test_forces_and_rates_of_a_chain():
    """Closed by 2 mm: 5000 N; closing at 0.1 m/s with 2.5e3 N s/m: 250 N; a quiet end takes 5e4 v,
    a fixed one 5e6 u, a matched one Z s / (Z + c) of the same spring and its dashpot c = 5e3."""
    ratio = 0.5e-3 * sqrt(2500.0)  # eta = 1e-3 s
    kinds, ends = ("free", "quiet", "fixed", "matched"), [0.0, 3000.0, -4500.0]
    ends.append(5e4 * (5e6 * -1e-3 + 5e3 * 0.06) / (5e4 + 5e3))
    for kind, force in zip(kinds, ends, strict=True):
        one = system_of(scene(joints={"damping_ratio": ratio}, ends={"end": kind}))
        state = state_of(one, [1e-3, -1e-3], [0.16, 0.06])
        if kind == "fixed":
            force = 5e6 * -1e-3 + 5e3 * 0.06
        forces = contact_forces(one, state, 1000.0)[:3]
        assert forces == pytest.approx([1000.0, 5250.0, force], rel=1e-12)
        slope = one.matrix @ state + 1000.0 * one.load
        assert one.displacement @ slope == pytest.approx([0.16, 0.06], rel=1e-12)
        expected = [-4.25, (5250.0 - force) / 1000]
        assert one.velocity @ slope == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize(
    ("kind", "drive", "start", "face"),
    [
        ("quiet", 1000.0, -7000.0, 0.0),  # the load less 5e4 * 0.16
        ("matched", 1000.0, 1000.0 - 5800 / 1.1, 5800 / 5.5e4),  # Z s / (Z + c), s / (Z + c)
        ("fixed", 0.06, -5500.0, 0.06),  # 5e6 * 1e-3 + 5e3 (0.16 - 0.06) of a wall that moves
    ],
)
def test_forces_of_a_held_start(kind, drive, start, face):
    """Under 1 mm and 0.16 m/s of its block; s = 5e6 * 1e-3 + 5e3 * 0.16."""
    quantity = {"quantity": "velocity"} if kind == "fixed" else {}
    load = {"shape": "step", "amplitude": 1000.0, **quantity}
    ratio = 0.5e-3 * sqrt(2500.0)  # eta = 1e-3 s
    one = system_of(scene(joints={"damping_ratio": ratio}, ends={"start": kind}, load=load))
    state = state_of(one, [1e-3, -1e-3], [0.16, 0.06])
    forces = contact_forces(one, state, drive)[:3]
    assert forces == pytest.approx([start, 5250.0, 0.0], rel=1e-12)
    slope = one.matrix @ state + drive * one.load
    assert slope[4] * one.displacement[0, 0] == pytest.approx(face, rel=1e-12)


def test_no_tension_in_a_chain():
    """Open: nothing. Closed but parted faster than its dashpot lets it: nothing either."""
    ratio = 0.5e-3 * sqrt(2500.0)
    one = system_of(scene(joints={"damping_ratio": ratio, "tension": False}))
    for gap, rate, force in ((1e-6, -1.0, 0.0), (-1e-4, 0.2, 0.0), (-1e-4, 0.05, 125.0)):
        state = state_of(one, [0.0, gap], [0.0, rate])
        assert contact_forces(one, state)[1] == pytest.approx(force, abs=1e-9)


def test_frequencies_of_three_blocks():
    """k / m = 4: 0, 2 and sqrt(12) rad/s."""
    assert frequencies(4.0, 1.0, 3) == pytest.approx([0, 2, sqrt(12)], rel=1e-14)


def test_a_linear_system_step_by_step():
    """x' = -3 x + 2 f, a step of height 1 from 5: 2/3 + (5 - 2/3) e^-3h."""
    load = drive(scene(load={"shape": "step", "amplitude": 1.0}))
    found = advance(np.array([[-3.0]]), np.array([2.0]), np.array([5.0]), load, 0.0, 0.7)
    assert found == pytest.approx([2 / 3 + 13 / 3 * exp(-2.1)], rel=1e-13)


def test_drive():
    """The base's velocity: as given, or 3 t of an acceleration of 3 m/s2."""
    load = {"shape": "step", "amplitude": 3.0, "quantity": "acceleration"}
    base = {"ends": {"start": "fixed"}}
    assert drive(scene(load=load, **base)).value(np.array([0.0, 2.0])).tolist() == [0, 6]
    load["quantity"] = "velocity"
    assert drive(scene(load=load, **base)).value(np.array([-1.0, 2.0])).tolist() == [0, 3]


@pytest.mark.parametrize("solve", [images.solve, EQUIVALENT.run])
def test_a_step_in_the_free_bar(solve):
    """At 0.5 m until 0.07 s, then nothing until 0.09 s; v = 2 mm/s a passage: f / Z = 0.02 m/s."""
    at = {"stress": [0.5], "velocity": [0.5], "interval": 0.02}
    found = solve(scene(0.12, record=at))
    rel = 1e-10 if solve is images.solve else 1e-3
    holds(found.stress[0], [0, 1000, 1000, 1000, 0, 1000, 1000], rel)
    holds(along(found.velocity)[0], [0, 0.02, 0.02, 0.02, 0.04, 0.06, 0.06], rel)
    ways = [0, 2e-4, 6e-4, 1e-3, 1.6e-3, 2.6e-3, 3.8e-3]
    holds(along(found.displacement)[0], ways, rel)


@pytest.mark.parametrize(("start", "enters"), [("free", 1000.0), ("quiet", 500.0)])
def test_images_of_a_fixed_end(start, enters):
    """The stress doubles when the wave returns, 0.07 s, and the rock is at rest."""
    at = {"stress": [0.5], "velocity": [0.5], "interval": 0.02}
    found = images.solve(scene(0.08, record=at, ends={"start": start, "end": "fixed"}))
    holds(found.stress[0], np.array([0, 1, 1, 1, 2]) * enters)
    holds(along(found.velocity)[0], np.array([0, 1, 1, 1, 0]) * enters / 5e4)


def one_layer(**tables):
    """Return the cubes between quiet ends, on 1 / K = 1 / 0.5e6 - 1 / 2.5e6: K = 0.625e6 Pa/m."""
    rock = {"density": 1000.0, "equivalent_modulus": 2.5e6, "equivalent_poisson": 0.25}
    rock["intact_modulus"] = 5e6
    layer = {"y": 1.0, "normal_stiffness": 1 / (1 / 0.5e6 - 1 / 5e6)}
    tables |= {"record": {"stress": [0.5, 1.5], "velocity": [0.5, 1.5], "interval": 0.01}}
    ends = {"start": "quiet", "end": "quiet"}
    return scene(0.12, rock=rock, soft_layers=[layer], ends=ends, **tables)


@pytest.mark.parametrize("solve", [one_joint.solve, EQUIVALENT.run])
def test_a_step_meets_one_joint(solve):
    """Half of it enters; Z / 2 K = 0.04 s: 500 (1 - e^(-t / 0.04)) passes, the rest comes back."""
    found = solve(one_layer())
    t = 0.01 * np.arange(13)
    passed = np.where(t >= 0.03, 500 * (1 - np.exp(-np.maximum(t - 0.03, 0) / 0.04)), 0)
    met = np.where(t >= 0.01, 500.0, 0)
    back = np.where(t >= 0.03, -500 * np.exp(-np.maximum(t - 0.03, 0) / 0.04), 0)
    keep = (np.abs(t - 0.01) > 0.001) & (np.abs(t - 0.03) > 0.001)  # there it jumps
    rel = 1e-9 if solve is one_joint.solve else 2e-3
    holds(found.stress[1], passed, rel)
    holds(found.stress[0][keep], (met + back)[keep], rel)
    holds(along(found.velocity)[0][keep], (met - back)[keep] / 5e4, rel)


def test_jointed_bar_before_anything_comes_back():
    """Intact rock has z = sqrt(2) Z: sqrt(2) / (1 + sqrt(2)) of the load enters beside a dashpot Z;
    z / 2 K_n after its arrival 1 / e of it has yet to pass the joint."""
    found = JOINTED.run(one_layer())
    enters, speed, lag = 1000 * sqrt(2) / (1 + sqrt(2)), 50 * sqrt(2), sqrt(2) * 0.045
    holds(found.stress[0, 1:3], [enters, enters], rel=1e-3)
    passed = enters * (1 - exp(-(0.03 - 1.5 / speed) / lag))
    holds(found.stress[1, 1:4], [0, 0, passed], rel=2e-3)


@pytest.mark.parametrize("end", ["fixed", "matched"])
def test_far_end_of_the_jointed_bar(end):
    """The joint passes s (1 - e^-at), a = 2 K_n / z, which a wall doubles; before the dashpot Z
    stands half of a joint: f' + b f = 2 a s (1 - e^-at) with b = a + 2 K_n / Z = a + 200."""
    rock = {"density": 1000.0, "equivalent_modulus": 2.5e6, "equivalent_poisson": 0.25}
    rock["intact_modulus"] = 5e6
    at = {"stress": [2.0], "velocity": [1.5], "interval": 0.01}
    found = JOINTED.run(scene(0.06, rock=rock, ends={"start": "quiet", "end": end}, record=at))
    t, a = np.array([0.03, 0.04, 0.05]) - 2 / (50 * sqrt(2)), 1e7 / (5e4 * sqrt(2))
    b, twice = a + 200, 2000 * sqrt(2) / (1 + sqrt(2))
    late, soon = np.exp(-a * t), np.exp(-b * t)
    expected = {"fixed": 1 - late, "matched": a * ((1 - soon) / b - (late - soon) / 200)}[end]
    holds(found.stress[0, :6], [0, 0, 0, *(twice * expected)], rel=2e-3)


def test_series_of_the_free_bar():
    """1000 sin(2 pi t / 0.04) in rock at rest: its peak at 0.5 m at 0.02 s, its zero at 0.03 s."""
    load = {"shape": "sine", "amplitude": 1000.0, "period": 0.04}
    at = {"stress": [0.5], "velocity": [0.5], "interval": 0.005}
    found = SERIES.run(scene(0.065, load=load, record=at), n_terms=600)
    half = 1000 / sqrt(2)
    wave = [0, 0, 0, half, 1000, half, 0, -half, -1000, -half, 0, 0, 0, 0]
    holds(found.stress[0], wave, rel=3e-3)
    holds(along(found.velocity)[0], np.array(wave) / 5e4, rel=3e-3)
    way = 1000 / 5e4 * 0.04 / (2 * pi)
    ways = [0, 0, 0, 1 - 1 / sqrt(2), 1, 1 + 1 / sqrt(2), 2, 1 + 1 / sqrt(2), 1, 1 - 1 / sqrt(2), 0]
    holds(along(found.displacement)[0][:11], np.array(ways) * way, rel=3e-3)


def test_modes_of_two_masses():
    """K = [[4, -4], [-4, 4]], masses 1: 2 sqrt(2) rad/s, and at rest against each other."""
    found = modes(np.ones(2), np.array([[-2.0, 2.0]]))
    assert found.omega.tolist() == [pytest.approx(2 * sqrt(2)), 0.0]
    assert np.abs(found.shapes) == pytest.approx(np.full((2, 2), 1 / sqrt(2)))


def test_one_damped_joint_among_others_is_damped():
    pillar = {"length": 4.0, "side": 1.0, "block": 1.0}
    one = scene(pillar=pillar, soft_layers=[{"y": 2.0, "damping_ratio": 0.1}])
    assert joints_are_damped(calibrate(one)) and not joints_are_damped(calibrate(scene()))
    assert images.applies(one).reason == "the joints are damped"


def test_how_far_images_and_matrices_go():
    """A million times 4 m at 50 m/s are 8e4 s; and 2000 blocks."""
    assert images.applies(scene(7.99e4)) and not images.applies(scene(8.01e4))
    for blocks, held in ((2000, True), (2001, False)):
        pillar = {"length": float(blocks), "side": 1.0, "block": 1.0}
        assert bool(row_of_blocks.applies(scene(pillar=pillar))) is held


def test_nothing_slides_along_where_gravity_pulls_across():
    gravity = {"direction": [1.0, 0.0, 0.0], "acceleration": 9.81, "static": False}
    one = {"joints": {"friction_angle": 30.0}, "ends": {"end": "fixed"}}
    one["load"] = {"shape": "step", "amplitude": 0.0}
    assert not sliding_block.applies(scene(gravity=gravity, **one))
    gravity["direction"] = [0.0, 1.0, 0.0]
    assert sliding_block.applies(scene(gravity=gravity, **one))


@pytest.mark.parametrize(
    ("count", "passed"),
    [(2, (0.7822, 0.8890, 0.9864)), (3, (0.7927, 0.9995, 0.9138)), (5, (0.9963, 0.8840, 0.9468))],
)
def test_parallel_joints(count, passed):
    """kappa = 1, spacings of 0.05, 0.1 and 0.2 wavelengths: by the product of their matrices."""
    for spacing, expected in zip((0.05, 0.1, 0.2), passed, strict=True):
        found = parallel_joints.transmission(count, 1.0, spacing)
        assert found == pytest.approx(expected, abs=5.1e-5)
        turn = np.exp(-2j * pi * spacing)
        one = np.array([[1 + 0.5j, -0.5j], [0.5j, 1 - 0.5j]]) @ np.diag([1 / turn, turn])
        whole = np.linalg.matrix_power(one, count)
        assert found == pytest.approx(1 / max(np.abs(np.diag(whole))), rel=1e-12)


def test_one_of_parallel_joints():
    """2 kappa / sqrt(4 kappa^2 + 1), for any spacing."""
    for kappa, passed in ((0.5, 1 / sqrt(2)), (1.0, 2 / sqrt(5)), (2.0, 4 / sqrt(17))):
        for spacing in (0.0, 0.1):
            found = parallel_joints.transmission(1, kappa, spacing)
            assert found == pytest.approx(passed, rel=1e-12)
    # At no distance two joints are one of half the stiffness.
    assert parallel_joints.transmission(2, 1.0, 0.0) == pytest.approx(1 / sqrt(2), rel=1e-7)


def test_thin_layer():
    """Z_2 / Z_1 = 0.1: contrast 9.9, sin(0.3) = 0.2955; a quarter wave of 0.5: 1 / (1 + 0.5625)."""
    assert thin_layer.transmission(0.1, 0.3) == pytest.approx(0.5643, abs=5e-5)
    assert thin_layer.transmission(0.5, pi / 2) == pytest.approx(0.8, rel=1e-14)
    assert thin_layer.joint(0.1, 0.3) == pytest.approx(1 / 3, rel=1e-14)


def test_column():
    """nu^2 k^2 a^2 / 12 and / 24; J = 0.1405770 a^4 (Timoshenko & Goodier, 109)."""
    assert column.love_rayleigh(0.25, 3.0, 2.0) == pytest.approx(0.0625 * 36 / 12, rel=1e-14)
    assert column.love_rayleigh(0.25, 3.0, 2.0, 2) == pytest.approx(0.0625 * 36 / 24, rel=1e-14)
    assert column.torsion_constant(2.0) == pytest.approx(16 * 0.1405770, rel=1e-6)
    assert column.torsion_speed(1000.0) == pytest.approx(918.4, abs=0.05)


def test_beam():
    """1.8751^2 sqrt(E h^2 / 12 rho L^4) = 3.516015 * 0.5; a slender one is stiff in shear."""
    found = beam.euler_bernoulli(12.0, 1.0, 0.5, 1.0)
    assert found == pytest.approx(3.516015 / 2, rel=1e-6)
    slender = beam.timoshenko(12.0, 0.25, 1.0, 1e-4, 1.0)
    assert slender == pytest.approx(3.516015e-4, rel=1e-6)
