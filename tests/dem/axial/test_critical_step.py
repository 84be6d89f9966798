"""The critical step is exact: just below it nothing grows, just above it the run is lost."""

import numpy as np
import pytest

from jointwave import dem
from jointwave.cases.errors import SceneError, UnstableError
from jointwave.cases.material.calibrate import calibrate
from jointwave.dem.axial.stability import critical_chain_step

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


@pytest.mark.parametrize("changes", CHAINS.values(), ids=CHAINS)
def test_growth_changes_sign_at_the_critical_step(pillar, step_matrix, changes):
    """No eigenvalue of the step leaves the unit circle below; one does 0.1 % above.

    Double eigenvalues at one (rigid motion) split by the square root of round-off, 1e-8.
    """
    scene = pillar(pillar__length=12.0, record={"stress": [5.0]}, **changes)
    p = calibrate(scene)
    critical = critical_chain_step(p, scene.ends.start, scene.ends.end)
    below, above = (
        np.abs(np.linalg.eigvals(step_matrix(scene, fraction * critical))).max()
        for fraction in (0.999, 1.001)
    )
    assert below < 1 + 1e-6
    assert above > 1 + 1e-3


def test_uniform_chain_has_the_textbook_value(pillar):
    """2 / omega_max with omega_max = 2 sqrt(k/m) cos(pi / 2N)."""
    p = calibrate(pillar())
    expected = p.spacing / p.bar_speed / np.cos(np.pi / (2 * p.block_count))
    assert critical_chain_step(p, "free", "free") == pytest.approx(expected, rel=1e-12)


def test_dashpots_lower_it_by_the_formula(pillar):
    """sqrt(4 eta^2 + 4 / omega_max^2) - 2 eta for joints that are all alike."""
    p = calibrate(pillar(joints__damping_ratio=0.1))
    undamped = critical_chain_step(calibrate(pillar()), "free", "free")
    eta = p.time_constant
    expected = np.sqrt(4 * eta**2 + undamped**2) - 2 * eta
    assert critical_chain_step(p, "free", "free") == pytest.approx(expected, rel=1e-10)


def test_mass_damping_does_not_lower_it(pillar):
    """Centred, it sees nothing of the mode that alternates at every step."""
    p, damped = (calibrate(pillar(damping__mass_proportional=alpha)) for alpha in (0.0, 1e3))
    assert critical_chain_step(damped, "free", "fixed") == critical_chain_step(p, "free", "fixed")


def test_step_above_it_is_refused_with_both_numbers(pillar):
    """The message names the step that was asked for and the critical one."""
    scene = pillar(numerics__dem__step_fraction=1.5)
    critical = critical_chain_step(calibrate(scene), "free", "free")
    with pytest.raises(SceneError) as error:
        dem.simulate(scene)
    assert f"{critical:.4g}" in str(error.value) and f"{1.5 * critical:.4g}" in str(error.value)


def test_forced_step_above_it_is_caught_when_it_blows_up(pillar):
    """allow_unstable lets it run; what leaves its bounds is an UnstableError, not a result."""
    forced = {"numerics__dem__step_fraction": 1.5, "numerics__dem__allow_unstable": True}
    with pytest.raises(UnstableError, match=r"diverged at t = .*step_fraction to at most 0.9$"):
        dem.simulate(pillar(**forced, time__duration=2.0, record__interval=1e-3))


def test_forced_step_is_taken_or_refused_never_shortened(pillar):
    """A sampling interval below the forced step is a mistake that the message names."""
    forced = {"numerics__dem__step_fraction": 1.5, "numerics__dem__allow_unstable": True}
    with pytest.raises(SceneError, match=r"record\.interval"):
        dem.simulate(pillar(**forced))
