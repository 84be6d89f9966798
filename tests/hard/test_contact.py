"""Joints at the edge of opening."""

import numpy as np
import pytest

from hard_runs import EPS, JOINTED, HardRun, marked
from jointwave.compare.misfit.metrics import relative_l2

LOOSE = {"joints.tension": False, "time.duration": 0.03}
SLOW = [("continuum-jointed", "explicit"), ("continuum-jointed", "implicit")]
EVERY = [one for one in JOINTED if one[1] != "fourth-order"]  # force evaluation has a sample


@pytest.mark.parametrize(("engine", "scheme"), marked(EVERY, SLOW))
def test_prestress_of_just_the_largest_tension_leaves_every_joint_closed(engine, scheme):
    """The elastic pillar under the same prestress, p, gives that tension; there the traction of
    tension-free joints is zero, to round-off, and they behave like elastic ones."""
    run = HardRun(engine, scheme, LOOSE)
    dt = 0.5 * run.critical
    clock = {"step": 0.5, "record__interval": dt, "record__velocity": []}
    clock["record__stress"] = run.properties.joint_y.tolist()
    free = run.run(**clock, joints__tension=True, prestress__normal=0.0)
    p = -float(free["stress"].values.min())
    bound, loose = (
        run.run(**clock, joints__tension=tension, prestress__normal=p)["stress"].values
        for tension in (True, False)
    )
    assert relative_l2(loose, bound) <= 10 * EPS * float(free.attrs["steps"])


@pytest.mark.parametrize(("engine", "scheme"), marked(JOINTED, SLOW[1:]))
def test_gaps_of_1e_40_m_open_and_close_like_large_ones(engine, scheme):
    """Tension-free joints have no scale: a load smaller by a power of two gives the same result in
    every digit."""
    run, small = HardRun(engine, scheme, LOOSE), 2.0**-99
    one, other = (run.run(load__amplitude=a)["stress"].values for a in (1.0, small))
    assert np.array_equal(other / small, one)
