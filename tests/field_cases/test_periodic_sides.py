"""Columns and jointed rock between periodic sides: what passes one side comes in at the other.

The two-layer column is that of SPECFEM3D's issues 1772 and 1773 and SPECFEM2D's 1240: 128 m of rock
with a shear speed of 224 m/s over 448 m/s, of equal density, struck from a quiet base below 256 m
of the lower rock."""

import numpy as np
import pytest

from jointwave.cases.errors import SceneError
from jointwave.cases.loads import history_of
from jointwave.cases.read import load_tables
from jointwave.compare.engines import solve
from jointwave.compare.misfit.metrics import relative_l2
from tests.field_cases.scenes import ENGINES, JOINT, P_SPEED, SIDES, mass, wave

PERIODIC = {"left": "periodic", "right": "periodic"}
PULSE = {"shape": "ricker", "quantity": "velocity", "amplitude": 0.1}


def rock(s_speed, density=2000.0):
    """Return rock of this speed (m/s) with nu = 0.25: G = 0.4 E."""
    return {"density": density, "intact_modulus": 2.5 * density * s_speed**2}


def column(height, base, moved=(1.0, 0.0), **tables):
    """Return rock between periodic sides, from a quiet base that moves to a free top."""
    base = PULSE | base | {"kind": "base", "side": "bottom", "direction": list(moved)}
    held = PERIODIC | {"bottom": "quiet"}
    return load_tables(mass(8.0, height, boundaries=held, loads=[base], **tables))


def second_order(way, block):
    """Return the relative L2 misfit of a Ricker wavelet after a way through a lattice of blocks,
    both in units of c T.

    The phase is behind by way (2 pi f)^3 block^2 / 24, from omega = (2 c / d) sin(k d / 2); the
    half block at the quiet base passes 1 + (omega d / c)^2 / 16 of the wave. The root mean squares
    of (f T)^3 and (f T)^2 over the wavelet's energy, of density f^4 exp(-2 f^2), are 1.81 and 1.48.
    """
    return 1.81 * (2 * np.pi) ** 3 * way * block**2 / 24 + 1.48 * (2 * np.pi * block) ** 2 / 16


@pytest.mark.parametrize("component, ratio", [(0, 1.0), (1, 3**0.5)], ids=["S", "P"])
def test_a_column_without_joints_has_the_wave_of_d_alembert(component, ratio):
    """v(y, t) = f(t - y / c) + f(t - (2 H - y) / c), read in the middle of rigid blocks; c is the
    speed in confined rock, and the motion across it is none."""
    height, period, block = 99.0, 0.2, 2.0
    scene = column(
        height,
        {"period": period},
        np.eye(2)[component],
        rock=rock(5e4**0.5),
        time={"duration": 1.6},
        record={"points": [[3.0, 48.0], [5.0, 98.0]]},
        numerics={"dem": {"block": block}},
    )
    pulse, speed = history_of(scene.loads[0], 0.1), ratio * 5e4**0.5
    longest = (2 * height - 48.0) / (speed * period)
    most = {"dem": second_order(longest, block / (speed * period)), "continuum-jointed": 3e-3}
    for engine in ENGINES:
        found = solve(engine, scene)
        for (_, y), moved in zip(scene.record.points, found.velocity.values, strict=True):
            ways = y, 2 * height - y
            exact = sum(pulse.value(found.time.values - way / speed) for way in ways)
            assert relative_l2(moved[:, component], exact) < most[engine], (engine, y)
            assert np.abs(moved[:, 1 - component]).max() < 1e-12


@pytest.mark.parametrize("sides", ["periodic", "quiet"])
@pytest.mark.parametrize("engine", ENGINES)
def test_two_layers_multiply_the_wave_between_them(engine, sides):
    """Twice 4/3 of the wave that enters at the surface, and from there -1/3 of it each 1.143 s:
    peaks of 2.667 and -0.889. Particles move to the left. Two metres below the surface, where the
    middle of a block is, both the wave that rises and the one that falls."""
    upper, lower, period, depth = 224.0, 448.0, 0.8, 2.0
    tables = mass(
        *(8.0, 384.0),
        rock=rock(lower),
        regions=[{"name": "upper", "through": [0.0, 256.0], **rock(upper)}],
        waves=[wave("S", period=period, quantity="velocity") | {"amplitude": 1.0}],
        boundaries={"left": sides, "right": sides, "bottom": "quiet", "top": "free"},
        time={"duration": 5.0},
        record={"points": [[2.0, 384.0 - depth]]},
        numerics={"dem": {"block": 4.0}},
    )
    scene = load_tables(tables)
    found, pulse = solve(engine, scene), history_of(scene.waves[0], 1.0)
    surface, times, first = -found.velocity.values[0, :, 0], found.time.values, 256 / lower
    exact = sum(
        4 / 3 * (-1 / 3) ** k * pulse.value(times - first - (128 * (1 + 2 * k) + s * depth) / upper)
        for k in range(4)
        for s in (-1, 1)
    )
    ways = (3 * 128 / upper, 4 / (upper * period)), (first, 4 / (lower * period))
    most = sum(second_order(way / period, block) for way, block in ways)
    assert relative_l2(surface, exact) < (most if engine == "dem" else 3e-3)
    later = times > first + 128 / upper + pulse.centre + 0.5
    assert surface.max() == pytest.approx(8 / 3, rel=0.02)
    assert surface[later].min() == pytest.approx(-8 / 9, rel=0.03)


def inclined(width=8.0, seam=0.0, stiffness=1e10, **numerics):
    """Return joints at 45 degrees, 4 m apart along the base, whose sides are at `seam` (m)."""
    joint = {"name": "joint", "dip": 45.0, "spacing": 8**0.5, "through": [-seam, 0.0]}
    law = {"normal_stiffness": 2 * stiffness, "shear_stiffness": stiffness}
    tables = mass(
        *(width, 40.0),
        joint_sets=[joint | law],
        waves=[wave(period=0.01)],
        boundaries=PERIODIC | {"bottom": "quiet", "top": "quiet"},
        time={"duration": 0.03},
        record={"points": [[3.1 - seam, 10.1], [3.1 - seam, 30.1]]},
        numerics=numerics,
    )
    return load_tables(tables)


def test_inclined_joints_pass_periodic_sides():
    """Neither the place of the sides nor the periods between them matter but for the mesh."""
    found = solve("continuum-jointed", inclined()).velocity.values
    for scene in (inclined(seam=1.7), inclined(16.0)):
        assert relative_l2(solve("continuum-jointed", scene).velocity.values, found) < 2e-3


def test_rigid_blocks_that_inclined_joints_weld_are_intact_rock():
    """Joints as stiff as a micrometre of rock: v = f(t - y / c). Triangles have all of the rock's
    stiffness, but the sides cut them in two, whose halves stay up to a third of a block apart:
    1.1 % off at blocks of 1 m, half of it at blocks half as large."""
    scene = inclined(stiffness=1e16, dem={"block": 1.0})
    found, speed = solve("dem", scene), P_SPEED
    pulse = history_of(scene.waves[0], 1e6 / (2600 * speed))
    for (_, y), moved in zip(scene.record.points, found.velocity.values, strict=True):
        assert relative_l2(moved[:, 1], pulse.value(found.time.values - y / speed)) < 0.015


def cell(sides, force, points, **tables):
    """Return 8 m x 8 m of rock with some periodic sides, which a force moves."""
    own = {
        "loads": [wave("force", [0.6, 0.8], quantity="force") | {"at": force}],
        "boundaries": dict.fromkeys(sides, "periodic"),
        "time": {"duration": 0.01},
        "record": {"points": points},
        "numerics": {"dem": {"block": 1.0}, "continuum": {"size": 1.0}},
    }
    return load_tables(mass(8.0, 8.0, **own | tables))


@pytest.mark.parametrize("engine", ENGINES)
def test_rock_between_two_pairs_of_periodic_sides_has_no_place(engine):
    """Moved by whole blocks and elements, across both sides, all moves alike."""
    force, by = np.array([3.5, 2.5]), np.array([3.0, 7.0])
    points = np.array([[1.5, 5.5], [6.5, 0.5]])
    moved = cell(SIDES, ((force + by) % 8).tolist(), ((points + by) % 8).tolist())
    one, other = (
        solve(engine, scene).velocity.values
        for scene in (cell(SIDES, force.tolist(), points.tolist()), moved)
    )
    assert np.abs(one).max() > 1e-3
    assert np.abs(one - other).max() < 1e-10 * np.abs(one).max()


@pytest.mark.parametrize("engine", ENGINES)
def test_bottom_and_top_are_joined_as_left_and_right_are(engine):
    """The same rock, mirrored at the line y = x."""
    joint = JOINT | {"spacing": 4.0, "through": [0.0, 1.0], "dip": 0.0}
    force, points = [3.2, 2.7], [[1.6, 5.6], [7.9, 7.2]]
    one = cell(("left", "right"), force, points, joint_sets=[joint])
    turned = cell(
        ("bottom", "top"),
        force[::-1],
        [point[::-1] for point in points],
        joint_sets=[joint | {"dip": 90.0, "through": [1.0, 0.0]}],
        loads=[wave("force", [0.8, 0.6], quantity="force") | {"at": force[::-1]}],
    )
    found, other = (solve(engine, scene).velocity.values for scene in (one, turned))
    assert np.abs(found).max() > 1e-3
    assert np.abs(found - other[..., ::-1]).max() < 1e-10 * np.abs(found).max()


@pytest.mark.parametrize("engine", ENGINES)
def test_joints_that_end_at_other_heights_are_refused(engine):
    """At 30 degrees joints climb 4.62 m over 8 m: those 3.46 m apart miss one another."""
    joint = JOINT | {"dip": 30.0, "spacing": 3.0, "through": [0.0, 1.0]}
    scene = cell(("left", "right"), [4.0, 4.0], [[2.0, 2.0]], joint_sets=[joint])
    with pytest.raises(SceneError, match="a joint of 'joint' ends there and not at the same place"):
        solve(engine, scene)
