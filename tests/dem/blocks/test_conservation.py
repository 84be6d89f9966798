"""What no law of a joint may change: momenta, energy, and the choice of axes.

The ledger is kept throughout, so that each law is compiled once.
"""

import numpy as np
import pytest

from jointwave.dem.blocks.leapfrog import march, samples_for
from jointwave.dem.blocks.model import state_at_rest
from jointwave.dem.blocks.tile import BEND, FORCE_X, FORCE_Y
from jointwave.dem.blocks.tiles import LANES
from jointwave.joints.law import Law
from jointwave.results.plane import TERMS

SIDE = 0.5  # of the blocks of `lattice`, m
STIFF = {"normal_stiffness": 9e9, "shear_stiffness": 4e9}
DASHPOTS = {"normal_viscosity": 9e5, "shear_viscosity": 4e5}
SLIP = {"cohesion": 2e4, "friction": 0.5}
WORN = {"dynamic_friction": 0.2, "weakening_distance": 2e-5}
WORN |= {"dilation": 0.1, "dilation_distance": 4e-5}
RATE = {"direct_effect": 0.01, "evolution_effect": 0.015, "critical_slip_distance": 1e-5}
RATE |= {"reference_rate": 1e-6, "initial_state": 1.0}
SOFTENING = {"tensile_strength": 5e4, "critical_opening": 3e-5}
LAWS = {
    "elastic": (STIFF, 0),
    "dashpots": (STIFF | DASHPOTS, 0),
    "dashpots, by points": (STIFF | DASHPOTS, 3),
    "no tension": (STIFF | {"carries_tension": 0.0}, 2),
    "slip": (STIFF | SLIP, 2),
    "slip with dashpots and lost cohesion": (
        STIFF | SLIP | DASHPOTS | {"residual_cohesion": 0.0},
        2,
    ),
    "slip that weakens and lifts, with dashpots": (STIFF | SLIP | WORN | DASHPOTS, 2),
    "rate and state": (STIFF | SLIP | RATE, 2),
    "softening": (STIFF | SLIP | SOFTENING | DASHPOTS, 2),
}
EACH = pytest.mark.parametrize("law", LAWS)


def kicked(model, seed=0):
    """Return a state with random velocities."""
    state = state_at_rest(model)
    state.v[:] = 0.02 * np.random.default_rng(seed).standard_normal(state.v.shape)
    return state


@EACH
def test_momentum_is_kept(law, lattice):
    """The forces of a joint cancel. Across periodic sides angular momentum has no meaning."""
    fields, points = LAWS[law]
    model, _ = lattice(Law(**fields), points, ledger=True)
    state, mass = kicked(model), model.blocks.inertia[:, :1]
    before = (mass * state.v[:, :2]).sum(axis=0)
    march(model, state, samples_for(model, 0), 1 << 40, (1, 2001))
    off = (mass * state.v[:, :2]).sum(axis=0) - before
    assert np.abs(off).max() < 1e-12 * np.abs(mass * state.v[:, :2]).sum()


@EACH
def test_each_block_gets_what_its_contacts_say(law, lattice):
    """A contact's force on j, and its moment about the contact's centre, are those on i but for the
    sign; what they give at the centroids, half a block away, is what each block's motion gains."""
    fields, points = LAWS[law]
    model, at = lattice(Law(**fields), points, ledger=True)
    contacts, number = model.contacts, 2 * len(at)
    model = model._replace(watched=np.arange(number))
    state, samples = kicked(model), samples_for(model, 1)
    march(model, state, samples, 1 << 40, (1, 101))
    before = state.v.copy()
    march(model, state, samples, 1 << 40, (0, 1))
    gained = model.blocks.inertia * (state.v - before) / model.blocks.dt
    pair = contacts.pair.reshape(len(contacts.pair), -1, LANES)[:, :2].swapaxes(0, 1)
    f, arm = samples.contact[..., 0], SIDE / 2 * np.repeat(np.eye(2), len(at), axis=0)
    turning = arm[:, 0] * f[:, FORCE_Y] - arm[:, 1] * f[:, FORCE_X]
    for blocks, sign in zip(pair.reshape(2, -1)[:, contacts.place] // 3, (-1, 1), strict=True):
        moment = sign * f[:, BEND] - turning  # the arm from j is the other way
        given = np.column_stack([sign * f[:, [FORCE_X, FORCE_Y]], moment])
        np.subtract.at(gained, blocks, given)
    assert np.abs(gained).max() < 1e-12 * np.abs(f[:, :3]).max() * len(f)


def ledger_of(law, lattice, step, count):
    """Return the terms of a run of random velocities, and the total [samples], J."""
    fields, points = LAWS[law]
    model, _ = lattice(Law(**fields), points, ledger=True, step=step)
    state, samples = kicked(model), samples_for(model, 101)
    march(model, state, samples, count // 100, (0, count + 1))
    energy = dict(zip(TERMS, samples.energy, strict=True))
    return energy, samples.energy.sum(axis=0) - 2 * energy["work"]


@pytest.mark.parametrize("law", [name for name in LAWS if name not in ("no tension", "softening")])
def test_the_ledger_closes(law, lattice):
    """What is stored and dissipated is what was there, to round-off; nothing is ever given back."""
    fields, _ = LAWS[law]
    energy, total = ledger_of(law, lattice, 0.25, 2000)
    assert np.abs(total - total[0]).max() < 1e-12 * total[0]
    for name in ("viscous", "friction"):
        assert (np.diff(energy[name]) > -1e-12 * total[0]).all()
    assert (energy["viscous"][-1] > 0.1 * total[0]) == ("normal_viscosity" in fields)
    assert (energy["friction"][-1] > 1e-3 * total[0]) == ("friction" in fields)


@pytest.mark.parametrize("law", ["no tension", "softening"])
def test_the_ledger_of_joints_that_open_closes_at_second_order(law, lattice):
    """In the step in which a joint opens its traction has a kink, and the mean of two values is off
    by half of K times the square of the gap's increment: over a time in which a number of joints
    open, by the square of the step, and 1e-3 of the whole here."""
    found = []
    for step, count in ((0.25, 1000), (0.25 / 4, 4000)):
        energy, total = ledger_of(law, lattice, step, count)
        found.append(np.abs(total - total[0]).max() / total[0])
        spent = energy["fracture"][-1]
        assert (spent > 1e-4 * total[0]) == (law == "softening")
    assert found[0] < 2e-3 and found[1] < found[0] / 4


@pytest.mark.parametrize("seed", [0, 1])
def test_the_ledger_closes_with_gravity_damping_and_what_acts_on_held_blocks(seed, lattice):
    """Forces that change at every step, dashpots of any shape, damping of blocks."""
    random = np.random.default_rng(seed)
    root = 1e3 * random.standard_normal((2, 3, 3))
    model, _ = lattice(
        Law(**STIFF, **SLIP), 2, True, mass_damping=200.0, local=0.1, gravity=(1.0, -9.0),
        held=(root @ root.transpose(0, 2, 1), np.array([3, 17])),
    )  # fmt: skip
    state, samples = kicked(model), samples_for(model, 51)
    drive = 1e5 * random.standard_normal((501, 2, 3))
    march(model, state, samples, 10, (0, 501), drive)
    energy = dict(zip(TERMS, samples.energy, strict=True))
    total = samples.energy.sum(axis=0) - 2 * energy["work"]
    assert np.abs(total - total[0]).max() < 1e-12 * np.abs(samples.energy).max()
    for name in ("viscous", "boundary", "work"):
        assert np.abs(energy[name]).max() > 1e-3 * np.abs(samples.energy).max()
