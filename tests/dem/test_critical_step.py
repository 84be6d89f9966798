"""The critical step is exact: just below it nothing grows, just above it the run is lost."""

import numpy as np
import pytest

from jointwave import dem
from jointwave.cases.errors import UnstableError
from jointwave.cases.material.calibrate import calibrate
from jointwave.dem.run import plan

SEGMENTS = [
    {"y": [2.0, 4.0], "density": 5000.0, "block": 0.25},
    {"y": [8.0, 12.0], "joints": False, "block": 0.4, "intact_modulus": 1e10},
]
QUIET = {"ends": {"start": "quiet", "end": "quiet"}}
MATCHED = {"ends": {"start": "matched", "end": "matched"}}
BETWEEN = {"ends": {"start": "matched", "end": "quiet"}}
HELD = {"ends": {"start": "matched", "end": "fixed"}}
DAMPED = {"joints__damping_ratio": 0.1}
RAYLEIGH = {"damping__rayleigh": {"frequencies": [50.0, 400.0], "ratios": [0.1, 0.1]}}
SOFT = {"spacing_stiffness": 4e8, "damping_ratio": 0.3}
STIFF = {"spacing_stiffness": 4e10}
CHAINS = {
    "one damped joint": {"soft_layers": [{"y": 5.0, "damping_ratio": 0.7}]},
    "soft damped layer, quiet": QUIET | DAMPED | {"soft_layers": [SOFT | {"y": 5.0}]},
    "matched at both, undamped": MATCHED,
    "segments": MATCHED | {"segments": SEGMENTS},
    "damped segments": BETWEEN | DAMPED | {"segments": SEGMENTS},
    "Rayleigh damping": HELD | RAYLEIGH,
}
FOURTH = {"rock__intact_modulus": None, "numerics__dem__scheme": "fourth-order"}
SOFTER = {"y": 5.0, "spacing_stiffness": 4e8}
FOURTH_ORDER = {
    "stiff layer": {"soft_layers": [STIFF | {"y": 5.0}]},
    "soft layer": {"soft_layers": [SOFTER], "ends__end": "fixed"},
}
BOTH = {"joints__damping_ratio": 0.05, "damping__mass_proportional": 50.0}
UNTURNED = {"motion__rotation": "none", "load__at": [0.0, 0.0]}
ROWS = {
    "soft layer": BOTH | BETWEEN | {"soft_layers": [SOFT | {"y": 2.0, "shear_stiffness": 5e8}]},
    "stiff layer": BOTH | HELD | {"soft_layers": [STIFF | {"y": 2.0, "shear_stiffness": 3e10}]},
    "slender": {"pillar__side": 0.2, "load__at": [0.05, 0.0]},
    "flat": {"pillar__side": 2.0},
    "blocks that do not turn": BETWEEN | UNTURNED,
}
SCENES = {f"chain, {name}": ("pillar", 12.0, changes) for name, changes in CHAINS.items()}
SCENES |= {f"4th order, {n}": ("pillar", 12.0, FOURTH | one) for n, one in FOURTH_ORDER.items()}
SCENES |= {f"row, {name}": ("row", 4.0, changes) for name, changes in ROWS.items()}
STEPS, EVERY = 100_000, 250


def critical(scene):
    """Return the critical step of a scene, s."""
    return plan(scene).critical


@pytest.mark.parametrize(("fixture", "length", "changes"), SCENES.values(), ids=SCENES)
def test_it_is_exact(request, fixture, length, changes):
    """Struck lightly: at 0.999 of it 100,000 steps leave no more motion than the first half of them
    has; 0.1 % above it the run is lost."""
    make, place = request.getfixturevalue(fixture), length / 2
    own = {"pillar__length": length, "load__amplitude": 1.0, **changes}
    probe = {"stress": [place], "velocity": [], "interval": 1e-4}
    known = critical(make(**own, record=probe, time__duration=1e-3))

    def run(fraction):
        dt = fraction * known
        forced = {"numerics__dem__step_fraction": fraction, "numerics__dem__allow_unstable": True}
        record = {"velocity": [0.3, place], "interval": EVERY * dt}
        result = dem.simulate(make(**own, **forced, record=record, time__duration=STEPS * dt))
        assert result.attrs["dt"] == pytest.approx(dt, rel=1e-9)
        return np.abs(result.velocity.values)

    v = run(0.999)
    half = v.shape[1] // 2
    assert v.any() and v[:, half:].max() < 2 * v[:, :half].max()
    with pytest.raises(UnstableError):
        run(1.001)


def test_uniform_chain_has_the_textbook_value(pillar):
    """2 / omega_max with omega_max = 2 sqrt(k/m) cos(pi / 2N); dashpots make it
    sqrt(4 eta^2 + 4 / omega_max^2) - 2 eta where joints are all alike."""
    p, damped = calibrate(pillar()), pillar(joints__damping_ratio=0.1)
    expected = p.spacing / p.bar_speed / np.cos(np.pi / (2 * p.block_count))
    assert critical(pillar()) == pytest.approx(expected, rel=1e-12)
    eta = calibrate(damped).time_constant
    expected = np.sqrt(4 * eta**2 + expected**2) - 2 * eta
    assert critical(damped) == pytest.approx(expected, rel=1e-10)


LAST = {
    "stiff": {"spacing_stiffness": 4e10},
    "stiff in shear": {"shear_stiffness": 3e10},
    "damped": {"damping_ratio": 0.5},
}


@pytest.mark.parametrize("layer", LAST.values(), ids=LAST)
def test_one_joint_beyond_the_first_blocks_counts(row, layer):
    """The last of 2009 joints alone decides, as the last of 9 does: its mode dies away from there
    by a factor of ten or so at every block."""
    brief = {"record": {"stress": [2.0]}, "time__duration": 1e-3}
    plain = brief | {"joints__damping_ratio": 0.01}
    short, whole = (
        critical(row(pillar__length=x, soft_layers=[{"y": x - 0.5, **layer}], **plain))
        for x in (5.0, 1005.0)
    )
    assert short < 0.95 * critical(row(pillar__length=5.0, **plain))
    assert whole == pytest.approx(short, rel=1e-9)


BREAKS = {"friction_angle": 20.0, "tensile_strength": 5e4, "fracture_energy": 1.0}


@pytest.mark.parametrize(
    "joints",
    [
        {"friction_angle": 20.0, "cohesion": 1e4},
        {"tension": False},
        pytest.param({"cohesion": 1e4, **BREAKS}, marks=pytest.mark.slow),
    ],
    ids=["slip", "no tension", "softening"],
)
def test_slip_and_opening_do_not_raise_it(row, joints):
    """At 0.999 of the critical step of joints that hold, energy stays what the load has put in."""
    scene = row(
        joints=joints,
        numerics__dem__step_fraction=0.999,
        record={"stress": [2.0], "interval": 3.717e-4},
        load__amplitude=1e4,
        time__duration=0.3,
    )
    result = dem.simulate(scene)
    assert result.attrs["dt"] > 0.998 * result.attrs["critical_dt"]
    energy = result.energy
    held = sum(energy.sel(term=term) for term in ("kinetic", "elastic"))
    assert float(held.max()) < 1.1 * float(energy.sel(term="work").max())


def test_local_damping_lowers_it(row):
    """By sqrt(1 + alpha): a force that turns a velocity round is 1 + alpha times as large.

    Two per cent above, the alternating mode grows until nothing is finite."""
    damped = {"damping__local": 0.5, "time__duration": 1.0}
    known = critical(row(**damped))
    assert known == pytest.approx(critical(row()) / np.sqrt(1.5), rel=1e-9)

    def at(fraction):
        forced = {"step_fraction": fraction, "allow_unstable": True}
        record = {"stress": [2.0], "interval": fraction * known}
        return row(**damped, load__amplitude=1e3, numerics__dem=forced, record=record)

    assert np.abs(dem.simulate(at(0.98)).stress.values).max() < 2e3
    with pytest.raises(UnstableError):
        dem.simulate(at(1.02))
