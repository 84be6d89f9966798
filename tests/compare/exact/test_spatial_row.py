"""The spatial row's matrices against contact points summed one by one, and closed forms."""

import numpy as np
import pytest

from closed_forms import cantilever, leapfrog
from closed_forms.square_face import face_points
from jointwave.cases.material.calibrate import calibrate
from jointwave.compare.exact.blocks import row_of_blocks
from jointwave.compare.exact.blocks.pillar import bodies, system_of
from jointwave.compare.exact.blocks.system import relative

SHORT = {
    "pillar": {"length": 3.0, "side": 0.7, "block": 0.5},
    "record": {"stress": [1.0], "velocity": []},
}
RECORD = {"velocity": [0.25 + 0.5 * i for i in range(6)], "interval": 1e-4}
FREE = SHORT | {"load": {"direction": [1.0, 0.0, 0.0]}}


def contact_forces(motions, stiffness, points, d):
    """Return F and M on the right side of each contact [N - 1, 6], point by point."""
    out = []
    for (u1, t1), (u2, t2), (K, Ks) in zip(motions[:-1], motions[1:], stiffness, strict=True):
        rel = u2 - u1 + d / 2 * np.array([t2[2] + t1[2], 0.0, -(t2[0] + t1[0])])
        phi, F, M = t2 - t1, np.zeros(3), np.zeros(3)
        for x, z, area in zip(*points, strict=True):
            gap = rel[1] + phi[2] * x - phi[0] * z
            slip = rel[0] + phi[1] * z, rel[2] - phi[1] * x
            f = -area * np.array([Ks * slip[0], K * gap, Ks * slip[1]])
            F, M = F + f, M + np.cross([x, 0.0, z], f)
        out.append(np.concatenate([F, M]))
    return np.array(out)


def block_forces(contacts, d):
    """Return force and torque on every block [N, 6] of the contacts between them."""
    out = np.zeros((len(contacts) + 1, 6))
    for j, c in enumerate(contacts):
        lever = np.array([0.0, 0.0, 0.0, -d / 2 * c[2], 0.0, d / 2 * c[0]])
        out[j + 1] += c + lever
        out[j] += -c + lever
    return out


@pytest.mark.parametrize(
    "n, rule", [(None, "vertices"), (1, "midpoint"), (2, "midpoint"), (3, "gauss")]
)
def test_springs_push_as_the_sum_over_the_points(scene, n, rule):
    """Round-off: some hundred terms, each known to 1e-16."""
    soft = [{"y": 1.5, "spacing_stiffness": 4e8, "shear_stiffness": 3e8}]
    at = scene(**FREE, soft_layers=soft, joints={"contact_points": n, "point_rule": rule})
    p, rng = calibrate(at), np.random.default_rng(3)
    q = rng.standard_normal((6, 6)) * [1, 1, 1, 2, 2, 2]
    motions = [(block[:3], block[3:]) for block in q]
    stiffness = list(zip(p.stiffness, p.shear_stiffness, strict=True))
    points = face_points(0.7, n, rule)
    expected = block_forces(contact_forces(motions, stiffness, points, 0.5), 0.5)
    found = -(system_of(at).stiffness @ q.ravel()).reshape(6, 6)
    assert np.abs(found - expected).max() < 1e-13 * np.abs(expected).max()


def test_a_motion_of_the_whole_row_strains_nothing(scene):
    y, turn = 0.5 * np.arange(6) + 0.25, np.array([0.3, -0.2, 0.7])
    shift = np.array([1.0, 2.0, 3.0])
    q = np.array([np.r_[shift + np.cross(turn, [0, yi, 0]), turn] for yi in y])
    mass, contacts = bodies(scene(**FREE))
    strains = relative(contacts, *mass.shape)[6:-6, :36] @ q.ravel()
    assert np.abs(strains).max() < 1e-14


@pytest.mark.parametrize("freedom", [0, 1, 2, 4])
def test_single_freedoms_are_chains_of_their_own(scene, freedom):
    """omega_n = 2 sqrt(k/m) sin(n pi / 2N): shear K'_s A, stretching K'_n A, torsion K'_s J / I_y
    with J = a^4/6; of shape cos(n pi (j - 1/2) / N)."""
    at = scene(**FREE, motion={"rotation": "small" if freedom == 4 else "none"})
    p = calibrate(at)
    k = (p.regular_stiffness if freedom == 1 else p.regular_shear_stiffness) * p.area
    m = p.block_mass
    if freedom == 4:
        k, m = p.regular_shear_stiffness * 0.7**4 / 6, m * 0.7**2 / 6
    one, omega = system_of(at), leapfrog.frequencies(k, m, 6)
    shapes = np.zeros((6, len(one.mass) // 6, 6))
    shapes[:, freedom] = np.cos(np.outer(np.arange(6) + 0.5, np.arange(6)) * np.pi / 6)
    shapes = shapes.reshape(-1, 6)
    inertial = omega**2 * one.mass[:, None] * shapes
    assert np.abs(one.stiffness @ shapes - inertial).max() < 1e-13 * np.abs(inertial).max()


def test_a_free_row_has_six_rigid_modes(scene):
    assert np.count_nonzero(leapfrog.modes_of_blocks(*bodies(scene(**FREE))).omega == 0) == 6


@pytest.mark.parametrize("axis, turns, sign", [(0, 2, 1), (2, 0, -1)])
@pytest.mark.parametrize("rule, share", [("vertices", 1.0), ("midpoint", 0.75)])
def test_the_cantilever_hangs_as_the_explicit_sum(scene, axis, turns, sign, rule, share):
    """A solve of a matrix whose condition grows as N^4, here 1e4: twelve digits. Towards the free
    start a block moves by theta_z l along x, and by -theta_x l along z."""
    direction = [0.0, 0.0, 0.0]
    direction[axis] = 1.0
    at = scene(
        **SHORT | {"record": {"stress": [0.0, 1.0, 3.0], **RECORD}},
        rock={"intact_modulus": None},  # half a joint at the wall
        load={"amplitude": 0.0},
        joints={"point_rule": rule},
        gravity={"direction": direction},
        ends={"end": "fixed"},
        time={"duration": 1e-3},
    )
    p, result = calibrate(at), row_of_blocks.solve(at)
    u, theta = cantilever.deflection(
        6,
        0.5,
        9.81 * p.block_mass,
        p.regular_shear_stiffness * p.area,
        p.regular_stiffness * share * 0.7**4 / 12,
    )
    assert np.allclose(result.displacement.values[:, -1, axis], u, rtol=1e-11)
    assert np.allclose(result.rotation.values[:, -1, turns], sign * theta, rtol=1e-11)
    shear = result.shear.values[:, -1, [0, 2].index(axis)]
    assert np.allclose(shear, 2400 * 9.81 * np.array([0.0, 1.0, 3.0]), rtol=1e-11, atol=1e-6)
    assert np.abs(result.velocity.values).max() == 0


def test_a_couple_on_the_free_face_is_carried_to_the_wall(scene):
    """Statics: in any section the moment of a couple is the couple itself, and no force."""
    couple = {"direction": [0.0, 0.0, 1.0], "arm": 0.3}
    at = scene(**SHORT, ends={"end": "fixed"}, load=couple)
    one, moves = system_of(at), slice(-1)  # all states but the base's
    state = np.linalg.solve(one.matrix.toarray()[moves, moves], -one.load[moves])
    forces = (one.forces[:, moves] @ state + one.direct).reshape(-1, 6)
    moment = 0.3 * at.pillar.area
    assert np.allclose(forces[:, 5], moment) and np.abs(forces[:, :5]).max() < 1e-9 * moment
