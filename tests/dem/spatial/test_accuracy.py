"""The engine against the row that is exact in time: rate and size of the error."""

import numpy as np
import pytest

from jointwave import dem
from jointwave.compare.exact.blocks import row_of_blocks
from jointwave.compare.misfit.metrics import relative_l2

SOFT = [{"y": 3.0, "spacing_stiffness": 4e8, "shear_stiffness": 5e8, "damping_ratio": 0.1}]
# A smooth pulse: at the kinks of a sine the load's mean over a step, which the stress at the start
# contains, is off by first order.
BLOW = {"shape": "ricker", "amplitude": 1e5, "period": 0.01, "direction": [0.48, 0.6, -0.64]}
SHAKEN = {
    "shape": "ricker",
    "amplitude": 1.0,
    "period": 0.01,
    "quantity": "velocity",
    "direction": [0.48, 0.6, -0.64],
}
ROWS = {
    "free": {"joints__damping_ratio": 0.05},
    "strongly damped": {"joints__damping_ratio": 0.5},
    "quiet, matched": {
        "ends": {"start": "quiet", "end": "matched"},
        "joints__damping_ratio": 0.05,
    },
    "matched, fixed": {
        "ends": {"start": "matched", "end": "fixed"},
        "joints__damping_ratio": 0.05,
    },
    "shaken base, quiet": {
        "ends": {"start": "fixed", "end": "quiet"},
        "load": {**SHAKEN, "amplitude": 100.0, "quantity": "acceleration"},
        "joints__damping_ratio": 0.05,
    },
    "soft layer, mass damping": {
        "soft_layers": SOFT,
        "ends": {"start": "matched", "end": "quiet"},
        "joints__damping_ratio": 0.02,
        "damping__mass_proportional": 50.0,
    },
    "shaken base": {
        "ends": {"start": "fixed", "end": "matched"},
        "load": SHAKEN,
        "joints__damping_ratio": 0.05,
    },
    "blocks that do not turn": {
        "motion__rotation": "none",
        "load": BLOW,
        "ends": {"start": "quiet", "end": "matched"},
        "joints__damping_ratio": 0.05,
    },
}
ECCENTRIC = {"load": {**BLOW, "at": [0.1, -0.05]}}
ORDER = 2.0
FIELDS = ("stress", "shear", "velocity", "displacement", "rotation")


def error(result, exact):
    """Return the root sum of squares of the relative L2 misfits of all fields."""
    fields = [name for name in FIELDS if name in result and exact[name].values.any()]
    return np.linalg.norm([relative_l2(result[k].values, exact[k].values) for k in fields])


@pytest.mark.parametrize("name", ROWS)
def test_second_order_against_the_time_exact_row(name, row, solved):
    """The error falls at order 2.00 +- 0.05 in the step, whatever the dashpots and the ends."""
    steps, errors = [], []
    for fraction in (0.1, 0.05, 0.025):
        scene = row(**ECCENTRIC | ROWS[name], numerics__dem__step_fraction=fraction)
        result = dem.simulate(scene)
        steps.append(result.attrs["dt"])
        errors.append(error(result, solved(name, row_of_blocks.solve, scene)))
    order = np.diff(np.log(errors)) / np.diff(np.log(steps))
    assert order == pytest.approx(ORDER, abs=0.05)


@pytest.mark.parametrize("name", ROWS)
def test_default_step_is_accurate(name, row, solved):
    """Below 0.05 % relative L2 in every field with no key of [numerics] set."""
    scene = row(**ECCENTRIC | ROWS[name])
    result, known = dem.simulate(scene), solved(name, row_of_blocks.solve, scene)
    misfits = {
        k: relative_l2(result[k].values, known[k].values)
        for k in FIELDS
        if k in result and known[k].values.any()
    }
    assert max(misfits.values()) < 5e-4
