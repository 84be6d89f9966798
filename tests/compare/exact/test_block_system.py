"""Blocks as first-order systems: Taylor series against matrix exponentials, and free flight."""

from functools import partial

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from closed_forms.bloch import masses
from jointwave.cases.histories import Ricker
from jointwave.cases.partition.scene import blocks_of_domain
from jointwave.cases.schema.domain import Domain
from jointwave.cases.schema.joint import JointSet
from jointwave.compare.exact.blocks.events import Loads, integrate
from jointwave.compare.exact.blocks.system import Contacts, contacts_of, first_order
from jointwave.compare.exact.linear import twins

SPRINGS, DASHPOTS, DENSITY, DURATION = [9e9, 4e9], [5e6, 3e6], 2500.0, 0.02
ATTITUDES = [(0.0, 0.0), (90.0, 90.0), (90.0, 0.0)]


def blocks_in(dim):
    """Return 4 by (2 by) 3 cubes of 1 m, as a system with dashpots below."""
    law = {"normal_stiffness": 1.0, "shear_stiffness": 1.0, "spacing": 1.0}
    facing = [{"dip_direction": way} if dim == 3 else {} for _, way in ATTITUDES]
    tables = [
        {"name": str(k), "dip": dip, **law, **more}
        for k, ((dip, _), more) in enumerate(zip(ATTITUDES, facing, strict=True))
    ]
    make = partial(JointSet.model_validate, context={"dimension": dim})
    size = [4.0, 3.0] if dim == 2 else [4.0, 2.0, 3.0]
    blocks = blocks_of_domain(Domain(size=size), list(map(make, tables[:dim])))
    inner, outer = blocks.contacts, blocks.boundary
    springs, dashpots = np.tile(SPRINGS, (len(inner), 1)), np.tile(DASHPOTS, (len(outer), 1))
    dashpots[outer.normal[:, -1] > -0.5] = 0.0
    parts = (
        contacts_of(blocks, inner, springs, 0 * springs),
        contacts_of(blocks, outer, 0 * dashpots, dashpots),
    )
    contacts = Contacts(*map(np.concatenate, zip(*parts, strict=True)))
    return first_order(masses(blocks, DENSITY), contacts)


def both(system, states):
    return np.stack([x @ states.T for x in (system.displacement, system.velocity)])


@pytest.mark.parametrize("dim", [2, 3])
def test_taylor_series_agree_with_matrix_exponentials(dim):
    """Under a Ricker pull of any direction on every block, to round-off."""
    system, pulse = blocks_in(dim), Ricker(1.0, 0.004)
    pull = np.random.default_rng(0).standard_normal(len(system.mass)) * system.mass
    system = system._replace(load=system.driven @ pull)
    times = np.linspace(0, DURATION, 101)
    expected = both(system, twins(system.matrix, system.load, pulse, times)[0])
    found = both(system, integrate(system, pulse, times, 0.004).states)
    assert (np.abs(found - expected).max(axis=(1, 2)) < 1e-12 * expected.max(axis=(1, 2))).all()


def test_cubics_between_samples_are_off_by_the_fourth_power_of_their_distance():
    system, pulse = blocks_in(2), Ricker(1.0, 0.004)
    system = system._replace(load=system.driven[:, [0, 4]].T)
    times, found = np.linspace(0, DURATION, 101), []
    share = np.array([1.0, 2.0])
    for samples in (401, 801, 6401):
        fine = np.linspace(0, DURATION, samples)
        values = CubicSpline(fine, np.outer(pulse.value(fine), share))
        found.append(both(system, integrate(system, Loads(values, fine), times).states))
    off = [np.abs(one - found[2]).max(axis=(1, 2)) / np.abs(found[2]).max((1, 2)) for one in found]
    assert (off[1] < 1e-7).all() and off[0] / off[1] == pytest.approx(16, rel=0.3)


@pytest.mark.parametrize("dim", [2, 3])
def test_free_blocks_fall(dim):
    """u = g t^2 / 2 of all blocks, to round-off, for any step."""
    system = blocks_in(dim)
    system = system._replace(resists=0 * system.resists)
    c = len(system.mass) // (12 if dim == 2 else 24)
    fall = np.tile(np.eye(c)[dim - 1] * -9.81, len(system.mass) // c)
    system = system._replace(load=system.driven @ (system.mass * fall))
    t = np.array([0.0, 0.02, 0.04])
    u, v = both(system, integrate(system, Loads(np.ones_like, np.zeros(0)), t).states)
    assert u == pytest.approx(np.outer(fall, t**2 / 2), rel=1e-9, abs=1e-15)
    assert v == pytest.approx(np.outer(fall, t), rel=1e-9, abs=1e-15)
