"""The critical step is exact: just below it nothing grows, just above it the run is lost."""

from dataclasses import replace

import numpy as np
import pytest

from jointwave import dem
from jointwave.cases.errors import SceneError, UnstableError
from jointwave.cases.material.calibrate import calibrate
from jointwave.dem.spatial.simulate import critical_step_of

SOFT = [{"y": 2.0, "spacing_stiffness": 4e8, "shear_stiffness": 5e8, "damping_ratio": 0.3}]
STIFF = [{"y": 2.0, "spacing_stiffness": 4e10, "shear_stiffness": 3e10}]
ROWS = {
    "elastic": {},
    "damped": {"joints__damping_ratio": 0.1},
    "soft layer, damped, quiet, matched": {
        "soft_layers": SOFT,
        "joints__damping_ratio": 0.05,
        "damping__mass_proportional": 50.0,
        "ends": {"start": "quiet", "end": "matched"},
    },
    "stiff layer, damped, matched, fixed": {
        "soft_layers": STIFF,
        "joints__damping_ratio": 0.05,
        "damping__mass_proportional": 50.0,
        "ends": {"start": "matched", "end": "fixed"},
    },
    "matched at both, damped": {
        "ends": {"start": "matched", "end": "matched"},
        "joints__damping_ratio": 0.1,
    },
    "quiet at both, damped": {
        "ends": {"start": "quiet", "end": "quiet"},
        "joints__damping_ratio": 0.1,
    },
    "quiet and fixed, damped": {
        "ends": {"start": "quiet", "end": "fixed"},
        "joints__damping_ratio": 0.1,
    },
    "slender": {"pillar__side": 0.2, "load__at": [0.05, 0.0]},
    "flat": {"pillar__side": 2.0},
    "blocks that do not turn": {
        "motion__rotation": "none",
        "load__at": [0.0, 0.0],
        "ends": {"start": "quiet", "end": "matched"},
        "joints__damping_ratio": 0.05,
    },
}


@pytest.mark.parametrize("changes", ROWS.values(), ids=ROWS)
def test_growth_changes_sign_at_the_critical_step(row, step_matrix, changes):
    """No eigenvalue of the step leaves the unit circle below; one does 0.1 % above.

    Double eigenvalues at one (rigid motion) split by the square root of round-off, 1e-8.
    """
    scene = row(pillar__length=4.0, record={"stress": [2.0]}, **changes)
    p = calibrate(scene)
    critical = critical_step_of(scene, p)
    below, above = (
        np.abs(np.linalg.eigvals(step_matrix(scene, p, fraction * critical))).max()
        for fraction in (0.999, 1.001)
    )
    assert below < 1 + 1e-6
    assert above > 1 + 1e-3


def test_long_rows_have_the_value_of_their_first_blocks(row):
    """Of 2000 blocks alike the largest eigenvalue is that of any longer row to 1e-6."""
    at = row(pillar__length=1000.0, record={"stress": [2.0]})
    p = calibrate(at)
    short = critical_step_of(
        at,
        replace(
            p,
            block_count=1000,
            stiffness=p.stiffness[:999],
            shear_stiffness=p.shear_stiffness[:999],
        ),
    )
    whole = critical_step_of(at, p)
    assert whole <= short
    assert short == pytest.approx(whole, rel=4e-6)


LAST = {
    "stiff": {"spacing_stiffness": 4e10},
    "stiff in shear": {"shear_stiffness": 3e10},
    "damped": {"damping_ratio": 0.5},
}


@pytest.mark.parametrize("layer", LAST.values(), ids=LAST)
def test_one_joint_beyond_the_first_blocks_counts(row, layer):
    """The last of 2009 joints alone decides, as the last of 9 does: its mode dies away from there
    by a factor of ten or so at every block."""
    critical = []
    for blocks in (10, 2010):
        length = 0.5 * blocks
        layers = [{"y": length - 0.5, **layer}]
        damping = {"joints__damping_ratio": 0.01}
        scene = row(pillar__length=length, soft_layers=layers, record={"stress": [2.0]}, **damping)
        critical.append(critical_step_of(scene, calibrate(scene)))
    plain = row(pillar__length=5.0, record={"stress": [2.0]}, **damping)
    assert critical[0] < 0.95 * critical_step_of(plain, calibrate(plain))
    assert critical[1] == pytest.approx(critical[0], rel=1e-9)


@pytest.mark.parametrize(
    "joints",
    [
        {"friction_angle": 20.0, "cohesion": 1e4},
        {"tension": False},
        {"friction_angle": 20.0, "cohesion": 1e4, "tensile_strength": 5e4, "fracture_energy": 1.0},
    ],
    ids=["slip", "no tension", "softening"],
)
def test_slip_and_opening_do_not_raise_it(row, joints):
    """At 0.999 of the critical step of joints that hold, energy stays what the load has put in."""
    scene = row(
        joints=joints,
        numerics__dem__step_fraction=0.999,
        record={"stress": [2.0], "interval": 3.717e-4},
        load={
            "shape": "sine",
            "amplitude": 1e4,
            "period": 0.01,
            "direction": [0.48, 0.6, -0.64],
            "at": [0.1, -0.05],
        },
        time__duration=0.3,
    )
    result = dem.simulate(scene)
    assert result.attrs["dt"] > 0.998 * result.attrs["critical_dt"]
    energy = result.energy
    held = sum(energy.sel(term=term) for term in ("kinetic", "rotation", "elastic"))
    assert float(held.max()) < 1.1 * float(energy.sel(term="work").max())


def test_step_above_it_is_refused_with_both_numbers(row):
    """The message names the step that was asked for and the critical one."""
    scene = row(numerics__dem__step_fraction=1.5)
    critical = critical_step_of(scene, calibrate(scene))
    with pytest.raises(SceneError) as error:
        dem.simulate(scene)
    assert f"{critical:.4g}" in str(error.value) and f"{1.5 * critical:.4g}" in str(error.value)


def test_local_damping_lowers_it(row):
    """By sqrt(1 + alpha): a force that turns a velocity round is 1 + alpha times as large.

    Two per cent above, the alternating mode grows until nothing is finite.
    """
    damped = {"damping__local": 0.5, "time__duration": 1.0}
    critical = critical_step_of(row(**damped), calibrate(row(**damped)))
    plain = critical_step_of(row(), calibrate(row()))
    assert critical == pytest.approx(plain / np.sqrt(1.5), rel=1e-9)

    def at(fraction):
        forced = {"step_fraction": fraction, "allow_unstable": True}
        record = {"stress": [2.0], "interval": fraction * critical}
        return row(**damped, load__amplitude=1e3, numerics__dem=forced, record=record)

    assert np.abs(dem.simulate(at(0.98)).stress.values).max() < 2e3
    with pytest.raises(UnstableError):
        dem.simulate(at(1.02))
