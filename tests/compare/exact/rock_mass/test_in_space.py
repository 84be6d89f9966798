"""Plane waves at parallel joints in space: those of the plane, turned, and SH waves."""

from math import atan2, degrees

import numpy as np
import pytest

from closed_forms.one_joint import relaxed_sine
from jointwave.cases.errors import SceneError
from jointwave.cases.incident import plane_wave
from jointwave.compare.engines import applies, solve
from jointwave.compare.exact.rock_mass.field import field_of
from jointwave.results.stress import tensors

TO_RIGHT, UP = np.array([-0.6, -0.8, 0.0]), np.array([0.0, 0.0, 1.0])  # x and y of the plane
CENTRE = np.array([30.0, 30.0, 15.0])  # of the plane's [20, 15]
QUIET = dict.fromkeys(("left", "right", "front", "back", "bottom", "top"), "quiet")
NORTH = {"dip": 0.0, "through": [0.0, 0.0, 15.0]}


def placed(place):
    return (CENTRE + (place[0] - 20.0) * TO_RIGHT + (place[1] - 15.0) * UP).tolist()


def directed(vector):
    return (vector[0] * TO_RIGHT + vector[1] * UP).tolist()


@pytest.fixture
def in_space(rock_mass, joint, wave):
    """Return the scene of `rock_mass` in a vertical plane of a box of 60 m by 60 m by 30 m."""

    def scene(waves):
        plane = rock_mass(waves=waves)
        azimuth = degrees(atan2(*-TO_RIGHT[:2])) % 360
        sets = [joint(dip=25.0, dip_direction=azimuth, through=placed([20.0, 15.0]))]
        there = []
        for one in waves:
            x, y = one["direction"]
            more = {"direction": directed([x, y]), "through": placed(one["through"])}
            if one["kind"] == "S":
                more["polarisation"] = directed([-y, x])
            there.append(one | more)
        record = {
            key: list(map(placed, getattr(plane.record, key))) for key in ("points", "joints")
        }
        tables = {"joint_sets": sets, "waves": there, "boundaries": QUIET, "record": record}
        return plane, rock_mass(domain={"size": [60.0, 60.0, 30.0]}, **tables)

    return scene


def test_waves_and_joint_of_a_vertical_plane_are_those_of_the_plane(in_space, wave):
    waves = [wave(kind=k, direction=[0.28, 0.96], through=[20.0, -25.0]) for k in "PS"]
    plane, space = in_space(waves)
    flat, found = solve("oblique-joint", plane), solve("oblique-joint", space)
    axes = np.array([TO_RIGHT, UP])
    for name in ("velocity", "displacement"):
        expected = flat[name].values @ axes
        assert abs(found[name].values - expected).max() < 1e-7 * abs(expected).max()
    frame = np.array([TO_RIGHT, UP, np.cross(TO_RIGHT, UP)])
    in_plane, expected = tensors(flat.stress.values), np.zeros((2, len(flat.time), 3, 3))
    expected[..., :2, :2] = in_plane
    expected[..., 2, 2] = 0.25 * np.trace(in_plane, axis1=2, axis2=3)
    expected = frame.T @ expected @ frame
    assert abs(tensors(found.stress.values) - expected).max() < 1e-7 * abs(expected).max()
    assert abs(found.gap.values - flat.gap.values).max() < 1e-7 * abs(flat.gap.values).max()
    slip = np.linalg.norm(found.slip.values, axis=2)
    assert np.allclose(slip, abs(flat.slip.values), rtol=0, atol=1e-7 * slip.max())


@pytest.mark.parametrize(
    "polarisation", [None, [0.0, 0.0, 1.0], [0.8, -0.6, 0.0], [0.3, 0.5, -0.2]]
)
def test_the_joint_obeys_its_law_in_its_own_frame(in_space, wave, polarisation):
    """Traction is minus the stiffness times the jump, across and along strike and dip, whatever the
    two planes in which the waves travel, and however S waves move rock."""
    _, scene = in_space([wave(direction=[0.28, 0.96], through=[20.0, -25.0])])
    other = {"direction": [0.352, 0.0, 0.936]}
    if polarisation:
        other |= {"kind": "S", "polarisation": polarisation}
    other = scene.waves[0].model_copy(update=other)
    scene = scene.model_copy(update={"waves": [*scene.waves, other]})
    found = solve("oblique-joint", scene)
    jump = np.concatenate([found.gap.values[..., None], found.slip.values], axis=2)
    expected = -np.array([1e10, 4e9, 4e9]) * jump
    size = abs(expected).max()
    assert abs(found.traction.values - expected).max() < 1e-6 * size
    assert abs(expected).max(axis=(0, 1)).min() > 0.01 * size


@pytest.mark.parametrize("degrees", [0.0, 20.0, 50.0])
@pytest.mark.parametrize("azimuth", [0.0, 65.0])
def test_sh_in_closed_form(rock_mass, joint, wave, degrees, azimuth):
    """A sine of the period T passes a horizontal joint as s, tau s' + s = v_I of
    tau = Z_s cos(phi) / 2 K_s; v_I - s comes back. It moves rock along b alone, and stress along
    the joint, sigma_xb, is that of the front, Z_s sin(phi) v."""
    phi, turn, T = np.radians(degrees), np.radians(azimuth), 0.005
    t, up = np.array([np.sin(turn), np.cos(turn), 0.0]), np.array([0.0, 0.0, 1.0])
    n, b = np.sin(phi) * t + np.cos(phi) * up, np.cross(t, up)
    sh = wave(kind="S", shape="sine", direction=[*n], polarisation=[*b], through=[10.0, 10.0, -5.0])
    z = np.array([8.0, 22.0])
    record = {"points": [[9.0, 7.0, 8.0], [9.0, 7.0, 22.0]], "joints": []}
    scene = rock_mass(
        domain={"size": [20.0, 20.0, 30.0]},
        joint_sets=[joint(**NORTH)],
        waves=[sh],
        boundaries=QUIET,
        record=record,
    )
    found = solve("oblique-joint", scene)
    Z, c, w = 2500 * 8e6**0.5, 8e6**0.5, 2 * np.pi / T
    tau = Z * np.cos(phi) / (2 * 4e9)

    def came(s):
        return np.where((s > 0) & (s < T), np.sin(w * s), 0.0)

    along = (np.array([9.0, 7.0]) - 10) @ t[:2] * np.sin(phi) / c
    there, back = (along + (x + 5) * np.cos(phi) / c for x in (z, 2 * 15.0 - z))
    times = found.time.values
    passed = [relaxed_sine(times - late, w, T, tau) for late in (back[0], there[1])]
    front = came(times - there[0]) + came(times - back[0]) - passed[0]
    expected = 1e6 / Z * np.array([front, passed[1]])
    moved = found.velocity.values
    bound = found.velocity_error.values @ np.abs(b)
    assert (np.sqrt(np.mean((moved @ b - expected) ** 2, axis=1)) <= bound + 1e-9).all()
    assert abs(moved - (moved @ b)[..., None] * b).max() < 1e-9 and abs(expected).max() > 0.05
    pressed = np.einsum("pnij,i,j->pn", tensors(found.stress.values), t, b)
    assert np.allclose(pressed, Z * np.sin(phi) * expected, rtol=0, atol=2e3)


@pytest.mark.parametrize("changes", [{}, {"kind": "S", "polarisation": [0.5, -0.6, 0.3]}])
def test_the_field_on_sides_is_that_of_the_solution(in_space, wave, changes):
    _, scene = in_space([wave(direction=[0.28, 0.96], through=[20.0, -25.0])])
    one = scene.waves[0].model_copy(update=changes)
    scene = scene.model_copy(update={"waves": [one]})
    exact = solve("oblique-joint", scene)
    velocity, stress = field_of(scene)(np.array(scene.record.points), exact.time.values)
    assert abs(velocity.swapaxes(1, 2) - exact.velocity.values).max() < 1e-8
    assert abs(stress.swapaxes(1, 2) + exact.stress.values).max() < 1e-8 * 1e6 * 10


@pytest.mark.parametrize("kind", ["P", "S"])
def test_a_free_face_along_the_joints_sends_waves_back(rock_mass, joint, wave, kind):
    """Twice the pulse, the way it moves rock, behind a joint too stiff to be met."""
    more = {"polarisation": [0.6, 0.8, 0.0]} if kind == "S" else {}
    up = wave(kind=kind, direction=[0.0, 0.0, 1.0], **more)
    sides = QUIET | ({} if more else dict.fromkeys(("left", "right", "front", "back"), "roller"))
    stiff = joint(**NORTH, normal_stiffness=1e18, shear_stiffness=1e18)
    scene = rock_mass(
        domain={"size": [20.0, 20.0, 30.0]},
        joint_sets=[stiff],
        waves=[up],
        boundaries=sides | {"top": "free"},
        record={"points": [[10.0, 10.0, 0.0], [10.0, 10.0, 30.0]], "joints": []},
    )
    assert not applies("oblique-joint", scene)
    assert applies("parallel-joints", scene)
    found = solve("parallel-joints", scene).velocity.values
    way = np.array(more.get("polarisation", [0.0, 0.0, 1.0]))
    speed = {"P": 4898.979, "S": 2828.427}[kind]
    assert abs(found @ way).max(axis=1)[1] == pytest.approx(2e6 / (2500 * speed), rel=1e-3)
    across = found - (found @ way)[..., None] * way
    assert abs(across).max() < 1e-6 * abs(found).max()
    bottom = field_of(scene)(np.array(scene.record.points), np.linspace(0, 0.03, 301))
    assert abs(bottom.velocity.swapaxes(1, 2) - found).max() < 1e-6 * abs(found).max()


def test_why_waves_do_not_enter_regions_is_said(rock_mass, wave):
    """Soft rock above sends S waves down at 25 degrees, from which P waves in the rock decay,
    unless particles move along the boundary."""
    down = {"direction": [0.3, 0.3, -(0.82**0.5)], "polarisation": [0.0, 0.0, 1.0]}
    changes = {
        "domain": {"size": [60.0, 60.0, 30.0]},
        "regions": [{"name": "soft", "through": [0.0, 0.0, 15.0], "intact_modulus": 2e10}],
        "joint_sets": [],
        "waves": [wave(kind="S", through=[30.0, 30.0, 30.0], **down)],
        "boundaries": QUIET,
        "record": {"points": [[30.0, 30.0, 10.0]], "joints": []},
    }
    with pytest.raises(SceneError, match=r"regions, where .* has an evanescent wave in a region"):
        field_of(rock_mass(**changes))
    # SH waves scatter no P: 2 Z cos / (Z cos + Z' cos') of their velocity is transmitted.
    changes["waves"][0] |= {"polarisation": [0.5**0.5, -(0.5**0.5), 0.0]}
    scene, times = rock_mass(**changes), np.linspace(0, 0.03, 3001)
    found = field_of(scene)(np.array([[30.0, 30.0, 10.0]]), times).velocity[0]
    squares = np.array([2e10, 5e10]) / 2.5 / 2500
    slow, fast = 2500 * np.sqrt(squares * (1 - 0.18 * squares / squares[0]))  # Z cos
    sent = plane_wave(scene, scene.waves[0]).pulse.value(times)
    share = np.linalg.norm(found, axis=0).max() / np.abs(sent).max()
    assert share == pytest.approx(2 * slow / (slow + fast), rel=1e-3)
