"""What acts on blocks from outside, in one, two and three dimensions: points on facets, resultants,
dashpots, loads and waves, against closed forms."""

from itertools import product

import numpy as np
import pytest

from jointwave.cases.geometry.blocks import blocks_of
from jointwave.cases.geometry.cell_complex import box
from jointwave.cases.geometry.cut import cut, one_plane
from jointwave.cases.geometry.measure import along_and_across
from jointwave.cases.histories import Ricker
from jointwave.cases.incident import FreeField, PlaneWave
from jointwave.cases.material.rock import ElasticRock, elastic_rock
from jointwave.cases.partition.scene import blocks_of_scene, shape_of
from jointwave.cases.sampling import Clock
from jointwave.dem.sides.boundaries import (
    TURNS,
    dashpots,
    facets_on,
    freedoms,
    points_on,
    resultants,
)
from jointwave.dem.sides.domain import incoming, load_pattern
from jointwave.dem.sides.loads import Loads
from tests.rocks import rock

SIZE = np.array([3.0, 2.0, 2.5])
SIDES = ("left", "right", "front", "back", "bottom", "top")
CLOCK = Clock(dt=1e-4, stride=1, samples=400)
ROTATIONS = {1: 0, 2: 1, 3: 3}
STRESS = np.array([[3e6, 1e6, -5e5], [1e6, 2e6, 7e5], [-5e5, 7e5, 4e6]])


def whole(dim):
    """One box, whose facets on the low and high end of axis k are the sides 2 k and 2 k + 1."""
    found = blocks_of(box(np.zeros(dim), SIZE[:dim]), 1e-9)
    edge = found.boundary
    axis = np.abs(edge.normal).argmax(axis=1)
    edge.side[:] = 2 * axis + (edge.normal[np.arange(len(axis)), axis] > 0)
    return found


def polytope(dim):
    """A box whose corners three oblique planes have cut off, with the rest of it removed."""
    rng, body = np.random.default_rng(dim), box(np.zeros(dim), SIZE[:dim])
    middle = SIZE[:dim] / 2
    for normal in rng.normal(size=(3, dim)):
        normal /= np.linalg.norm(normal)
        through = middle + 0.8 * normal
        body = cut(body, one_plane(normal, normal @ through, np.ones(body.count, bool)), 1e-9).body
    depth = body.depths(middle)
    return blocks_of(body.removed(depth < depth.max(), 1), 1e-9)


@pytest.mark.parametrize("dim", [1, 2, 3])
def test_a_linear_stress_has_the_resultants_of_its_volume(dim):
    """Of a stress s + g x about the centroid, by the divergence theorem: the force V div g, the
    sums of arm times force V s."""
    rng = np.random.default_rng(dim)
    s, g = rng.normal(size=(dim, dim)), rng.normal(size=(dim, dim, dim))
    blocks = polytope(dim)
    at = points_on(blocks, np.arange(len(blocks.boundary)))
    traction = np.einsum("mi,mij->mj", at.normal, s + np.einsum("ijk,mk->mij", g, at.arm))
    found = resultants(at.arm, at.area[:, None] * traction).sum(axis=0)
    expected = np.append(np.einsum("iji->j", g), s)
    np.testing.assert_allclose(found, blocks.volume[0] * expected, atol=1e-13 * SIZE.prod())


@pytest.mark.parametrize("dim", [1, 2, 3])
def test_dashpots_take_the_power_of_every_rigid_motion(dim):
    """The integral of v Z v with a velocity linear along each facet, from its moments: of every
    freedom and of every sum of two, which is every number of the matrix."""
    rng, blocks = np.random.default_rng(dim), polytope(dim)
    edge, Z = blocks.boundary, rng.uniform(1e6, 9e6, 2)
    points = points_on(blocks, np.arange(len(edge)))
    impedance = along_and_across(points.normal, np.tile(Z, (len(points.block), 1)))
    onto = freedoms(dim, ROTATIONS[dim])
    C = onto @ dashpots(points, impedance, points.block, 1)[0] @ onto.T

    def power(velocity):
        middle, turning = np.split(velocity, [dim])
        spin, found = np.zeros((dim, dim)), 0.0
        for w, (i, j) in zip(turning, TURNS[ROTATIONS[dim]], strict=True):
            spin[j, i], spin[i, j] = w, -w
        for k, n in enumerate(edge.normal):
            resists = Z[0] * np.outer(n, n) + Z[1] * (np.eye(dim) - np.outer(n, n))
            v = middle + spin @ (edge.centroid[k] - blocks.centroid[0])
            found += edge.area[k] * v @ resists @ v
            found += np.trace(spin.T @ resists @ spin @ edge.second_moment[k])
        return found

    for one, other in product(np.eye(len(onto)), repeat=2):
        velocity = one + other
        assert velocity @ C @ velocity == pytest.approx(power(velocity), rel=1e-13)
    np.testing.assert_allclose(C, C.T, rtol=1e-14, atol=1e-9)


@pytest.mark.parametrize(("dim", "kind"), [(1, "P"), (2, "P"), (2, "S"), (3, "P"), (3, "S")])
def test_a_wave_pushes_a_quiet_side_by_twice_its_impedance(dim, kind):
    """At normal incidence from the left: 2 rho c A times the mean of the velocity over each step,
    along its polarisation, and no moment but that of the lever; sampled, to (omega dt)^2 / 24."""
    rock, pulse, blocks = ElasticRock(2500.0, 4000.0, 2300.0), Ricker(1.0, 0.01), whole(dim)
    speed = rock.p_speed if kind == "P" else rock.s_speed
    along, moves = np.eye(dim)[0], np.eye(dim)[0 if kind == "P" else dim - 1]
    wave = FreeField((PlaneWave(rock, along, moves, speed, np.zeros(dim), pulse),))
    points = points_on(blocks, facets_on(blocks, SIDES, ["left"]))
    pair = np.tile([rock.p_impedance, rock.s_impedance], (len(points.block), 1))
    impedance = along_and_across(points.normal, pair)
    rows, onto = np.zeros(1, int), freedoms(dim, ROTATIONS[dim])
    made = (wave, lambda places, times: wave(places, times))
    delayed, sampled = (
        Loads(rows, [], incoming(one, 0.01, points, impedance, rows, CLOCK), CLOCK, onto)
        for one in made
    )
    steps = np.arange(400)
    mean = np.diff(pulse.impulse(CLOCK.dt * (np.arange(401) - 0.5))) / CLOCK.dt
    force = 2 * rock.density * speed * SIZE[1:dim].prod() * mean[:, None] * moves
    found = delayed.drive(steps)[:, 0]
    np.testing.assert_allclose(found[:, :dim], force, atol=1e-12 * force.max())
    lever = -SIZE[0] / 2 * along
    moments = resultants(lever[None], force[:, None])[:, 0] @ onto.T
    np.testing.assert_allclose(found, moments, atol=1e-12 * force.max())
    off = np.abs(sampled.drive(steps)[:, 0] - found).max()
    assert off < 10 * (2 * np.pi / 0.01 * CLOCK.dt) ** 2 / 24 * force.max()
    some = delayed.resultants(steps[::7], rows)[:, 0] @ onto.T
    np.testing.assert_allclose(some, found[::7], atol=1e-12 * force.max())


def test_loads_of_a_scene_in_space():
    """A pressure on the top, a force at a point of the second block, a compliant base below."""
    step, at = {"amplitude": 2.0, "shape": "step"}, [2.5, 0.5, 1.0]
    joint = {"dip": 90.0, "dip_direction": 90.0, "through": [1.5, 1.0, 1.0]}
    force = {"kind": "force", "quantity": "force", "at": at, "direction": [0.0, 0.6, 0.8]}
    base = {"kind": "base", "quantity": "velocity", "side": "bottom", "direction": [1, 0, 0]}
    pushes = [step | one for one in ({"kind": "pressure", "side": "top"}, force, base)]
    scene = rock(SIZE.tolist(), [joint], loads=pushes, boundaries={"bottom": "quiet"})
    blocks, sides = blocks_of_scene(scene), shape_of(scene.domain).sides
    patterns = [load_pattern(scene, blocks, sides, one) for one in scene.pushes]
    loads = Loads(np.arange(2), patterns, [], CLOCK, freedoms(3, 3))
    found = loads.drive(np.array([3, 4]))[1]
    arm, force = at - blocks.centroid[1], 2 * np.array([0.0, 0.6, 0.8])
    face, shear = SIZE[0] * SIZE[1], 2 * elastic_rock(scene.rock).s_impedance
    expected = face * np.array([[shear, 0, -1, 0, -shear * SIZE[2] / 2, 0]] * 2)
    expected[1] += np.append(force, np.cross(arm, force))
    np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-6)
