"""The critical step is exact: just below it nothing grows, just above it the run is lost."""

import numpy as np
import pytest

from jointwave import dem
from jointwave.cases.errors import SceneError, UnstableError
from jointwave.cases.material.calibrate import calibrate

SEGMENTS = [
    {"y": [2.0, 4.0], "density": 5000.0, "block": 0.25},
    {"y": [8.0, 12.0], "joints": False, "block": 0.4, "intact_modulus": 1e10},
]
CHAINS = {
    "undamped": {},
    "damped": {"joints__damping_ratio": 0.1},
    "one damped joint": {"soft_layers": [{"y": 5.0, "damping_ratio": 0.7}]},
    "stiff layer": {"soft_layers": [{"y": 5.0, "spacing_stiffness": 4e10}]},
    "soft damped layer": {
        "joints__damping_ratio": 0.05,
        "soft_layers": [{"y": 5.0, "spacing_stiffness": 4e8, "damping_ratio": 0.3}],
    },
    "quiet": {"ends__end": "quiet", "ends__start": "quiet", "joints__damping_ratio": 0.1},
    "matched": {"ends__end": "matched", "joints__damping_ratio": 0.1},
    "matched at both, undamped": {"ends__end": "matched", "ends__start": "matched"},
    "segments": {"segments": SEGMENTS, "ends__end": "matched"},
    "damped segments": {
        "segments": SEGMENTS,
        "joints__damping_ratio": 0.1,
        "ends": {"start": "matched", "end": "quiet"},
    },
    "fixed": {"ends__end": "fixed", "joints__damping_ratio": 0.1},
    "mass damping": {"damping__mass_proportional": 500.0, "ends__end": "quiet"},
    "Rayleigh damping": {
        "damping__rayleigh": {"frequencies": [50.0, 400.0], "ratios": [0.1, 0.1]},
        "ends": {"start": "matched", "end": "fixed"},
    },
}
FOURTH = {"rock__intact_modulus": None, "numerics__dem__scheme": "fourth-order"}
FOURTH_ORDER = {
    "free": {},
    "fixed": {"ends__end": "fixed"},
    "stiff layer": {"soft_layers": [{"y": 5.0, "spacing_stiffness": 4e10}]},
    "soft layer": {"soft_layers": [{"y": 5.0, "spacing_stiffness": 4e8}], "ends__end": "fixed"},
}
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
SCENES = {f"chain, {name}": ("pillar", 12.0, changes) for name, changes in CHAINS.items()}
SCENES |= {f"4th order, {n}": ("pillar", 12.0, FOURTH | one) for n, one in FOURTH_ORDER.items()}
SCENES |= {f"row, {name}": ("row", 4.0, changes) for name, changes in ROWS.items()}
STEPS, EVERY = 100_000, 250


def critical(scene):
    """Return the critical step of a scene, s."""
    return dem.simulate(scene).attrs["critical_dt"]


@pytest.fixture
def stepped(request):
    """Return a function that runs a scene of a fixture, struck lightly, for 100,000 steps of a
    fraction of the critical one."""

    def run(fixture, length, changes, fraction):
        make = request.getfixturevalue(fixture)
        own = {"pillar__length": length, "load__amplitude": 1.0, **changes}
        place = length / 2
        probe = {"stress": [place], "velocity": [], "interval": 1e-4}
        dt = fraction * critical(make(**own, record=probe, time__duration=1e-3))
        forced = {"numerics__dem__step_fraction": fraction, "numerics__dem__allow_unstable": True}
        record = {"velocity": [0.3, place], "interval": EVERY * dt}
        result = dem.simulate(make(**own, **forced, record=record, time__duration=STEPS * dt))
        assert result.attrs["dt"] == pytest.approx(dt, rel=1e-9)
        return result

    return run


@pytest.mark.parametrize("name", SCENES)
def test_nothing_grows_below_the_critical_step(name, stepped):
    """At 0.999 of it 100,000 steps leave no more motion than the first half of them has."""
    v = np.abs(stepped(*SCENES[name], 0.999).velocity.values)
    half = v.shape[1] // 2
    assert v.any() and v[:, half:].max() < 2 * v[:, :half].max()


@pytest.mark.parametrize("name", SCENES)
def test_motion_grows_above_the_critical_step(name, stepped):
    """0.1 % above it the run is lost."""
    with pytest.raises(UnstableError):
        stepped(*SCENES[name], 1.001)


def test_uniform_chain_has_the_textbook_value(pillar):
    """2 / omega_max with omega_max = 2 sqrt(k/m) cos(pi / 2N); dashpots make it
    sqrt(4 eta^2 + 4 / omega_max^2) - 2 eta where joints are all alike."""
    p, damped = calibrate(pillar()), pillar(joints__damping_ratio=0.1)
    expected = p.spacing / p.bar_speed / np.cos(np.pi / (2 * p.block_count))
    assert critical(pillar()) == pytest.approx(expected, rel=1e-12)
    eta = calibrate(damped).time_constant
    expected = np.sqrt(4 * eta**2 + expected**2) - 2 * eta
    assert critical(damped) == pytest.approx(expected, rel=1e-10)


def test_mass_damping_does_not_lower_it(pillar):
    """Centred, it sees nothing of the mode that alternates at every step."""
    plain, damped = (
        critical(pillar(damping__mass_proportional=alpha, ends__end="fixed"))
        for alpha in (0.0, 1e3)
    )
    assert damped == plain


@pytest.mark.parametrize("engine", ["pillar", "row"])
def test_step_above_it_is_refused_with_both_numbers(request, engine):
    """The message names the step that was asked for and the critical one."""
    scene = request.getfixturevalue(engine)
    known = critical(scene())
    with pytest.raises(SceneError) as error:
        dem.simulate(scene(numerics__dem__step_fraction=1.5))
    assert f"{known:.4g}" in str(error.value) and f"{1.5 * known:.4g}" in str(error.value)


FORCED = {"numerics__dem__step_fraction": 1.5, "numerics__dem__allow_unstable": True}


def test_forced_step_above_it_is_caught_when_it_blows_up(pillar):
    """allow_unstable lets it run; what leaves its bounds is an UnstableError, not a result."""
    with pytest.raises(UnstableError, match=r"diverged at t = .*step_fraction to at most 0.9$"):
        dem.simulate(pillar(**FORCED, time__duration=2.0, record__interval=1e-3))


def test_forced_step_is_taken_or_refused_never_shortened(pillar):
    """A sampling interval below the forced step is a mistake that the message names."""
    with pytest.raises(SceneError, match=r"record\.interval"):
        dem.simulate(pillar(**FORCED))


BRIEF = {"record": {"stress": [2.0]}, "time__duration": 1e-3}


def test_long_rows_have_the_value_of_their_first_blocks(row):
    """Of 2000 blocks alike the largest eigenvalue is that of any longer row to 1e-6."""
    short, whole = (critical(row(pillar__length=x, **BRIEF)) for x in (500.0, 1000.0))
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
    plain = BRIEF | {"joints__damping_ratio": 0.01}
    short, whole = (
        critical(row(pillar__length=x, soft_layers=[{"y": x - 0.5, **layer}], **plain))
        for x in (5.0, 1005.0)
    )
    assert short < 0.95 * critical(row(pillar__length=5.0, **plain))
    assert whole == pytest.approx(short, rel=1e-9)


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
    held = sum(energy.sel(term=term) for term in ("kinetic", "elastic"))
    assert float(held.max()) < 1.1 * float(energy.sel(term="work").max())


def test_local_damping_lowers_it(row):
    """By sqrt(1 + alpha): a force that turns a velocity round is 1 + alpha times as large.

    Two per cent above, the alternating mode grows until nothing is finite.
    """
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
