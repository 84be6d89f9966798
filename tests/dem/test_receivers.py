"""Receivers, mean stresses and snapshots of rigid blocks in one, two and three dimensions."""

from pathlib import Path

import meshio
import numpy as np
import pytest
from scipy.linalg import null_space

from jointwave.cases import load
from jointwave.cases.geometry.blocks import blocks_of
from jointwave.cases.geometry.cell_complex import box
from jointwave.cases.geometry.locate import sides_at
from jointwave.cases.geometry.measure import frames_of
from jointwave.cases.geometry.sets import PlaneSet, cut_by_sets
from jointwave.cases.partition.scene import blocks_of_scene
from jointwave.compare.exact.blocks.system import carried
from jointwave.compare.runs.output import write_pvd
from jointwave.dem.blocks.rock_mass import blocks_of as rigid_blocks
from jointwave.dem.contacts.faces import Contacts
from jointwave.dem.readings.receivers import (
    everywhere,
    read_by,
    stencils_in_rock,
    stencils_on_joints,
)
from jointwave.dem.readings.snapshots import triangles
from jointwave.dem.readings.waveforms import at_points, mean_stress, quantities
from jointwave.dem.run import simulate
from jointwave.dem.sides.boundaries import freedoms as freedoms_of
from jointwave.results.dataset import dataset
from jointwave.results.snapshots import SnapshotRecorder, snapshots_of
from jointwave.results.stress import stress_components
from tests.rocks import rock

WALL = Path(__file__).parents[2] / "cases/rock-mass/masonry-wall.toml"
SIZE, TOLERANCE = np.array([6.0, 5.0, 4.0]), 1e-9
DIMENSIONS = pytest.mark.parametrize("dim", (1, 2, 3))
ROTATIONS = {1: 0, 2: 1, 3: 3}


def blocks(dim, tilt=0.2):
    """A box cut by one set across each axis, at random angles: convex blocks of any shape."""
    draw, sets = np.random.default_rng(dim), []
    for k, axis in enumerate(np.eye(dim)):
        normal = axis + tilt * draw.uniform(-1, 1, dim) * (1 - axis)
        normal /= np.linalg.norm(normal)
        along = np.linalg.svd(normal[None])[2][1:]
        sets.append(PlaneSet(f"set {k}", normal, along, 1.3, through=SIZE[:dim] / 2.1))
    return blocks_of(cut_by_sets(box(np.zeros(dim), SIZE[:dim]), sets, TOLERANCE), TOLERANCE)


def all_faces(found):
    """Contacts, and the boundary as contacts with walls; part of their compliance is the rock's."""

    def both(name):
        return np.concatenate([getattr(x, name) for x in (found.contacts, found.boundary)])

    blocks, area, centroid = both("blocks"), both("area"), both("centroid")
    arm = centroid[:, None] - found.centroid[np.maximum(blocks, 0)]
    blocks, excess = (
        np.where(blocks < 0, found.count, blocks),
        np.tile([1e-10, 3e-10], (len(area), 1)),
    )
    faces = Contacts(blocks, area, frames_of(both("normal")), arm, excess=excess)
    return faces, centroid, both("second_moment")


def at(found, stencils):
    """Receivers at points of blocks that rotate."""
    dim = found.body.dim
    onto = freedoms_of(dim, ROTATIONS[dim])
    return read_by(found, all_faces(found)[0], onto, stencils, [])


def inside(found, count, seed=0):
    """Places in the rock."""
    dim = found.body.dim
    return np.random.default_rng(seed).uniform(0.01, 0.99, (count, dim)) * SIZE[:dim]


@DIMENSIONS
def test_an_affine_motion_of_blocks_in_rock_is_that_of_every_point(dim):
    """Cuts through intact rock: u = b + A x from the centroids, whatever the blocks' rotations."""
    found, draw = blocks(dim), np.random.default_rng(2).normal
    points, freedoms = inside(found, 40), dim + ROTATIONS[dim]
    sides = sides_at(found, points, 0)
    stencils = stencils_in_rock(found, points, sides, 0)
    receivers = at(found, stencils)
    A, b = draw(size=(dim, dim)), draw(size=dim)
    motion = draw(size=(found.count, freedoms, 1))
    motion[:, :dim, 0] = b + found.centroid @ A.T
    moved = at_points(receivers, motion[receivers.places])
    np.testing.assert_allclose(moved[:, 0], b + points @ A.T, rtol=0, atol=1e-12 * np.abs(A).max())
    assert (np.diff(receivers.places) > 0).all() and len(receivers.places) > dim


@DIMENSIONS
def test_points_between_joints_move_with_their_rigid_block(dim):
    """A rigid motion of all blocks is that of every point; on joints the mean of both sides."""
    found, draw = blocks(dim), np.random.default_rng(3).normal
    points, freedoms = inside(found, 20), dim + ROTATIONS[dim]
    on = found.contacts.centroid[:5]
    points = np.concatenate([points, on])
    sides = sides_at(found, points, dim)
    assert [len(own) for own in sides] == [1] * 20 + [2] * 5
    stencils = stencils_in_rock(found, points, sides, dim)
    receivers = at(found, stencils)
    b, phi = draw(size=dim), draw(size=freedoms - dim)

    def rigid(x):
        return b + carried(x, freedoms)[:, :dim, dim:] @ phi

    motion = np.concatenate([rigid(found.centroid), np.tile(phi, (found.count, 1))], axis=1)
    moved = at_points(receivers, motion[receivers.places, :, None])
    np.testing.assert_allclose(moved[:, 0], rigid(points), rtol=0, atol=1e-13)
    if dim == 3:
        np.testing.assert_allclose(rigid(points), b + np.cross(phi, points), rtol=0, atol=1e-13)
    other = draw(size=(found.count, freedoms, 1))  # blocks move against each other
    moved = at_points(receivers, other[receivers.places])[20:, 0]
    i, j = (
        np.einsum("naf,nf->na", carried(on - found.centroid[k], freedoms)[:, :dim], other[k, :, 0])
        for k in found.contacts.blocks[:5].T
    )
    np.testing.assert_allclose(moved, (i + j) / 2, rtol=0, atol=1e-13)


def field(dim):
    """A stress in equilibrium that is linear in space, compression positive: S [d, d] at the
    origin and its gradient [d, d, d]."""
    draw, pairs = np.random.default_rng(4).normal, stress_components(dim)
    basis = []
    for i, j in pairs.values():
        for k in range(dim):
            one = np.zeros((dim, dim, dim))
            one[i, j, k] = one[j, i, k] = 1
            basis.append(one)
    basis = np.array(basis)
    balance = np.einsum("mijj->im", basis)
    free = null_space(balance)
    gradient = np.tensordot(free @ draw(size=free.shape[1]), basis, 1)
    S = draw(size=(dim, dim))
    return S + S.T, gradient


def samples_of(faces, centroid, second, S, gradient):
    """Samples of contacts under a linear stress: forces, and first moments of the traction."""
    at = S + np.einsum("ijk,ck->cij", gradient, centroid)
    force = faces.area[:, None] * np.einsum("cai,cij,cj->ca", faces.frame, at, faces.frame[:, 0])
    moment = np.einsum(
        "cbk,ckl,cai,ijl,cj->cba",
        faces.frame[:, 1:], second, faces.frame, gradient, faces.frame[:, 0],
    )  # fmt: skip
    rows = [force, moment.reshape(len(force), -1), np.zeros_like(force)]
    return np.concatenate(rows, axis=1)[:, :, None]


@DIMENSIONS
@pytest.mark.parametrize("uniform", (True, False))
def test_a_stress_in_equilibrium_is_the_mean_stress_of_every_block(dim, uniform):
    """By the divergence theorem V mean(S) = sum of x F, first moments of tractions included: of a
    stress that is linear in space that at the centroid."""
    found = blocks(dim, tilt=0.5)
    faces, centroid, second = all_faces(found)
    S, gradient = field(dim)
    gradient = 0 * gradient if uniform else gradient
    contact = samples_of(faces, centroid, second, S, gradient)
    stress = mean_stress(everywhere(found, faces), contact)
    expected = S + np.einsum("ijk,nk->nij", gradient, found.centroid)
    expected = np.stack([expected[:, i, j] for i, j in stress_components(dim).values()], axis=1)
    np.testing.assert_allclose(stress[:, 0], expected, rtol=0, atol=1e-10 * np.abs(expected).max())


@pytest.mark.parametrize("depth", ([], [2.0]), ids=["plane", "space"])
def test_a_block_that_a_force_turns_has_its_inertia_in_its_mean_stress(depth):
    """On a joint that all but lets it go, a = 1 m wide and h = 4 m high, pushed by F along x at its
    upper right corner: V sigma = h F / 4 - alpha rho (m_h - m_a) / 2, with alpha = h F / 2 rho
    (m_a + m_h) and second moments as a^2 to h^2, is F a^2 h / (2 (a^2 + h^2))."""
    across = [x / 2 for x in depth]
    push = {"kind": "force", "quantity": "force", "shape": "half-sine", "amplitude": 1e5}
    push |= {"at": [1.0, *across, 5.0], "direction": [1.0, *(0 * x for x in across), 0.0]}
    loose = {"dip": 0.0, "through": [0.0, *across, 1.0]}
    scene = rock(
        *([1.0, *depth, 5.0], [loose], {"normal_stiffness": 1e4, "shear_stiffness": 1e4}),
        boundaries={"bottom": "fixed"},
        loads=[push | {"period": 0.1}],
        time={"duration": 0.02},
        record={"points": [[0.3, *across, 1.9]], "interval": 1e-3},
    )
    found = simulate(scene)
    pushed, volume = 1e5 * np.sin(np.pi * found.time / 0.05), 4.0 * np.prod(depth)
    for component, sums in {"xz" if depth else "xy": 4 / 34, "xx": 1 / 2}.items():
        stress = -found.stress.sel(stress_component=component)[0]
        off = (stress * volume - sums * pushed)[1:]  # the first is the mean from half a step before
        assert np.abs(off).max() < 2e-3 * 1e5


@DIMENSIONS
def test_what_acts_from_outside_counts_as_contacts_do(dim):
    """The boundary as walls, or as sums of arm times force; without moments if none rotates."""
    found = blocks(dim)
    faces, centroid, second = all_faces(found)
    contact = samples_of(faces, centroid, second, *field(dim))
    receivers, inner = everywhere(found, faces), np.arange(len(found.contacts))
    whole = mean_stress(receivers, contact)
    only = contact.copy()
    only[inner] = 0
    outside = np.zeros((found.count, dim, dim, 1))
    part = mean_stress(receivers, only)[:, 0] * -found.volume[:, None]
    for (i, j), values in zip(stress_components(dim).values(), part.T, strict=True):
        outside[:, i, j, 0] = outside[:, j, i, 0] = values
    within = everywhere(found, faces.some(inner))
    other = mean_stress(within, contact[inner], outside)
    np.testing.assert_allclose(other, whole, rtol=0, atol=1e-12 * np.abs(whole).max())

    uniform = samples_of(faces, centroid, second, field(dim)[0], np.zeros((dim,) * 3))
    fewer = np.concatenate([uniform[:, :dim], uniform[:, -dim:]], axis=1)
    whole, part = mean_stress(receivers, uniform), mean_stress(receivers, fewer)
    np.testing.assert_allclose(part, whole, rtol=0, atol=1e-13 * np.abs(whole).max())


@DIMENSIONS
def test_joint_receivers_read_the_nearest_contact_or_along_the_joint(dim):
    """Whole joints by one contact; where cuts divide them linearly, from centre to centre."""
    found = blocks(dim, tilt=0.0)
    faces = all_faces(found)[0]
    inner = len(found.contacts)
    on = found.contacts.centroid[found.contacts.joint_set == 0]
    points = on + 0.2 * (np.eye(dim)[0] + (np.arange(dim) > 0))
    slope = np.random.default_rng(6).normal(size=(dim, dim))
    slope[:, 0] = 0  # it varies along the joint alone
    values = found.contacts.centroid @ slope.T
    values[found.contacts.normal[:, 0] < 0, 2:] *= -1  # up the dip, of block j
    contact = np.zeros((inner, dim * (dim + 1), 1))
    contact[:, :dim, 0] = values * found.contacts.area[:, None]
    contact[:, -dim:, 0] = 7 * values
    faces = faces.some(np.arange(inner))
    for along in (False, True):
        stencils = stencils_on_joints(found, points, 1, along)
        receivers = read_by(found, faces, freedoms_of(dim, 0), [], stencils)
        two = contact[receivers.watched] * [0.0, 1.0]  # the first sample counts as the start
        got = quantities(receivers, *np.zeros((2, 0, dim, 2)), two)
        assert set(got) == {"traction", "gap", *(("slip",) if dim > 1 else ())}
        ahead = points if along else on
        if along:  # but on the last contact of a joint there is none ahead
            last = (ahead[:, 1:] > found.contacts.centroid[:, 1:].max(axis=0) + 1e-9).any(axis=1)
        else:
            last = np.zeros(len(on), bool)
        expected = ahead @ slope.T
        np.testing.assert_allclose(got["traction"][~last, 1], expected[~last], atol=1e-12)
        np.testing.assert_allclose(
            got["gap"][~last, 1], (7 + 1e-10) * expected[~last, 0], rtol=0, atol=1e-12
        )
        if dim > 1:
            slip = got["slip"][~last, 1].reshape(-1, dim - 1)
            np.testing.assert_allclose(slip, (7 + 3e-10) * expected[~last, 1:], rtol=0, atol=1e-12)


def test_snapshots_show_whole_blocks():
    """The triangles of polyhedra look outward and enclose their volume."""
    found = blocks(3)
    owner, normal, pieces = found.faces(TOLERANCE)
    cells, piece = triangles(pieces)
    x = pieces.corners[cells]
    area = np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0]) / 2
    outward = (area * normal[piece]).sum(axis=1)
    np.testing.assert_allclose(outward, np.linalg.norm(area, axis=1), rtol=1e-9, atol=1e-15)
    volume = np.bincount(owner[piece], (x[:, 0] * area).sum(axis=1)) / 3
    np.testing.assert_allclose(volume, found.volume, rtol=1e-10)


def test_snapshots_of_a_scene_in_space(tmp_path):
    """The faces of all bricks, as they move, with six stresses; displacement from the start on."""
    (scene,) = load(WALL, {"record.fields": 0.05})
    found, bodies = blocks_of_scene(scene), rigid_blocks(scene).bodies
    draw, count = np.random.default_rng(8).normal, found.count
    frames = [
        (draw(size=(count, 6)), draw(size=(count, 6)), draw(size=(count, 6)), np.zeros(0))
        for _ in range(3)
    ]
    shown = [bodies.frame(*one) for one in frames]
    recorder = SnapshotRecorder(
        scene, len(bodies.corners), bodies[:4], lambda k: shown[k // recorder.every]
    )
    times = np.arange(2 * recorder.every + 1) * scene.interval
    for k in range(len(times)):
        recorder.record_if_due(k)
    s = snapshots_of(recorder.add_to(dataset(scene, "dem", times, {})))
    assert s.kind == "triangle" and len(s.time) == 3 and s.stress.shape[2] == 6
    assert len(np.unique(s.block)) == count and not s.displacement[0].any()
    arm = bodies.corners - found.centroid[bodies.owner]
    own = frames[2][1][bodies.owner]
    np.testing.assert_allclose(s.velocity[2], own[:, :3] + np.cross(own[:, 3:], arm), atol=1e-12)
    np.testing.assert_array_equal(s.stress[1], frames[1][2][s.block])
    path = write_pvd(tmp_path / "wall.pvd", s)
    held = meshio.read(path.with_name("wall-fields") / "0002.vtu")
    assert held.cell_data["stress"][0].shape == (len(s.cells), 6)
