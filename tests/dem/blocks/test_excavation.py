"""Rigid blocks around an opening that has been excavated from rock under stress."""

import numpy as np
import pytest

from jointwave.dem import simulate
from jointwave.dem.kernel.model import state_at_rest
from jointwave.dem.prepare import prepared
from jointwave.dem.relaxation import start
from tests.cases.material.block_stiffness import stiffness
from tests.turned import turned

STRESS = {"xx": 4e6, "yy": 5e6, "xy": 5e5}
TENSOR = np.array([[4e6, 5e5], [5e5, 5e6]])
TOLERANCE = 1e-13  # of the relaxation
SLIPS = {"friction_angle": 30.0, "point_rule": "gauss"}
TURN = np.array([[0.8, -0.6], [0.6, 0.8]])
HOLE = [[4.0, 4.0], [7.0, 4.0], [7.0, 6.0], [4.0, 6.0]]


@pytest.fixture
def excavated(rock_mass, joint):
    """Return 12 m by 10 m in blocks of 1 m by 1 m, stressed, with a hole of 3 m by 2 m, one set
    twice as stiff as the other; keyword arguments of the joints, and tables changed."""

    def scene(law=(), **tables):
        stiff = {"normal_stiffness": 2e10, "shear_stiffness": 8e9} | dict(law)
        sets = [
            joint(name="bed", dip=0.0, spacing=1.0, through=[0.0, 0.0], **dict(law)),
            joint(name="cross", dip=90.0, spacing=1.0, through=[0.0, 0.0], **stiff),
        ]
        table = {
            "domain": {"size": [12.0, 10.0], "openings": [HOLE]},
            "joint_sets": sets,
            "prestress": STRESS,
            "numerics": {"dem": {"block": None, "static_tolerance": TOLERANCE}},
            "record": {"points": [[4.5, 6.5]], "joints": [[5.5, 7.0]]},
        }
        return rock_mass(**(table | tables))

    return scene


def at_rest(scene):
    """Return a system and its state after excavation."""
    system = prepared(scene)
    state = state_at_rest(system.model)
    start(system, state)
    return system, state


def released(system):
    """Return the forces [N, 3] that walls lose: of the tensor on every edge at the opening."""
    part, sides = system.blocks.cut, system.blocks.sides
    edges, force = part.boundary, np.zeros((part.count, 3))
    for k in np.flatnonzero(edges.side == sides.index("opening 0")):
        pull = edges.area[k] * TENSOR @ edges.normal[k]
        arm = edges.ends[k].mean(axis=0) - part.centroid[edges.blocks[k, 0]]
        force[edges.blocks[k, 0]] += [*pull, arm[0] * pull[1] - arm[1] * pull[0]]
    return force.ravel()


def test_the_state_after_excavation_is_that_of_the_assembled_equations(excavated):
    """K q = f of blocks that always hold, by least squares, which like dynamic relaxation leaves
    out rigid motion; to the relaxation's tolerance, 1e-13 of 5 MPa on 54 m, over the stiffness of
    the slowest mode, 3e-3 of the largest."""
    system, state = at_rest(excavated({"point_rule": "gauss"}))
    K, f, count = stiffness(system.blocks), released(system), system.blocks.cut.count
    mass = np.sqrt(system.blocks.inertia.ravel())
    scaled, held = np.linalg.eigh(K / np.outer(mass, mass))
    assert (scaled[:3] < 1e-9 * scaled[-1]).all() and scaled[3] > 1e-4 * scaled[-1]
    q = held[:, 3:] @ ((held[:, 3:].T @ (f / mass)) / scaled[3:]) / mass
    off = np.abs(state.u[:count].ravel() - q).max()
    assert off < 1e-9 * np.abs(q).max()


def test_a_small_wave_is_not_hidden_by_what_is_out_of_balance(excavated, wave):
    """1 kPa beside 5 MPa: by default less is left of the static state than a thousandth of it."""
    small = {"waves": [wave(amplitude=1e3)]}
    found = simulate(excavated(SLIPS, numerics={"dem": {"block": None}}, **small)).velocity
    exact = simulate(excavated(SLIPS, **small)).velocity
    assert np.abs(found - exact).max() < 1e-3 * np.abs(exact).max()


@pytest.mark.parametrize("mirrored", [False, True])
def test_a_scene_in_other_axes_records_the_same(mirrored, excavated, wave):
    """To 1e-12 of the motion and of the stress, which the relaxation's tolerance is below."""
    matrix = TURN @ np.diag([-1.0, 1.0]) if mirrored else TURN
    own = excavated(SLIPS, waves=[wave(direction=[0.6, 0.8], through=[0.0, 0.0])])
    one, other = simulate(own), simulate(turned(own, matrix))
    assert one.static_steps > 0 and np.abs(one.slip).max() > 1e-6
    size = np.abs(one.velocity.values).max()
    assert np.abs(one.velocity.values @ matrix.T - other.velocity.values).max() < 1e-12 * size
    flips = np.array([1.0, np.linalg.det(matrix)])
    assert np.abs(one.traction.values * flips - other.traction.values).max() < 1e-12 * 5e6


def test_a_group_of_blocks_that_no_wall_holds_keeps_its_centre_of_mass(excavated, joint):
    """A slot parts the rock: what is below stands on a wall, what is above comes to rest around an
    opening of its own, under horizontal stress alone, which puts no force on the whole."""
    slot, hole = ([[0, 2], [12, 2], [12, 3], [0, 3]], [[4, 5], [7, 5], [7, 7], [4, 7]])
    dips = {"bed": (0.0, 1.0), "cross": (90.0, 1.5), "oblique": (60.0, 4.0)}
    scene = excavated(
        domain={"size": [12.0, 10.0], "openings": [slot, hole]},
        joint_sets=[
            joint(name=name, dip=dip, spacing=spacing, through=[0.3, 0.0])
            for name, (dip, spacing) in dips.items()
        ],
        prestress={"xx": 4e6, "yy": 0.0, "xy": 0.0},
        boundaries={"bottom": "fixed", "left": "free", "right": "free", "top": "free"},
        record={"points": [[5.5, 9.4]], "joints": []},
    )
    system, state = at_rest(scene)
    blocks = system.blocks
    above = blocks.centroid[:, 1] > 2.5
    moved, mass = state.u[: blocks.count, :2][above], blocks.inertia[above, 0]
    assert np.abs(moved).max() > 1e-4
    assert mass.max() > 10 * mass.min()
    assert np.abs(mass @ moved).max() < 1e-12 * (mass @ np.abs(moved)).max()
