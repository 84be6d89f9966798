"""The critical step is exact: just below it nothing grows, just above it the run is lost."""

import numpy as np
import pytest

import dem
from cases.calibrate import calibrate
from cases.errors import SceneError, UnstableError
from cases.sampling import Clock
from dem.model import build_model, critical_chain_step, state_at_rest
from dem.step import march

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
    "fixed": {"ends__end": "fixed", "joints__damping_ratio": 0.1},
}


def spectral_radius(scene, dt):
    """Return the largest growth in a step, by the eigenvalues of the engine's own step."""
    p = calibrate(scene)
    model = build_model(scene, p, Clock(dt, 1, 1))._replace(load=np.zeros(0))

    def parts(state):
        kept = [state.u, state.v, state.gap_rate]
        kept += [None if end is None else end[:1] for end in (state.start, state.end)]
        return [x for x in kept if x is not None]

    size = sum(x.size for x in parts(state_at_rest(model, p.block_count, False)))
    step = np.zeros((size, size))
    for i in range(size):
        state = state_at_rest(model, p.block_count, False)
        unit = np.zeros(size)
        unit[i] = 1.0
        at = 0
        for x in parts(state):
            x[:] = unit[at : at + x.size]
            at += x.size
        march(model, state, 0, 1)
        step[:, i] = np.concatenate(parts(state))
    return np.abs(np.linalg.eigvals(step)).max()


@pytest.mark.parametrize("changes", CHAINS.values(), ids=CHAINS)
def test_growth_changes_sign_at_the_critical_step(pillar, changes):
    """No eigenvalue of the step leaves the unit circle below; one does 0.1 % above.

    Double eigenvalues at one (rigid motion) split by the square root of round-off, 1e-8.
    """
    scene = pillar(pillar__length=12.0, record={"stress": [5.0]}, **changes)
    p = calibrate(scene)
    critical = critical_chain_step(p, scene.ends.start, scene.ends.end)
    assert spectral_radius(scene, 0.999 * critical) < 1 + 1e-6
    assert spectral_radius(scene, 1.001 * critical) > 1 + 1e-3


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


def test_step_above_it_is_refused_with_both_numbers(pillar):
    """The message names the step that was asked for and the critical one."""
    scene = pillar(numerics__dem__step_fraction=1.5)
    critical = critical_chain_step(calibrate(scene), "free", "free")
    with pytest.raises(SceneError) as error:
        dem.simulate(scene)
    assert f"{critical:.4g}" in str(error.value) and f"{1.5 * critical:.4g}" in str(error.value)


def test_forced_step_above_it_is_caught_when_it_blows_up(pillar):
    """allow_unstable lets it run; what is no longer finite is an UnstableError, not a result."""
    forced = {"numerics__dem__step_fraction": 1.5, "numerics__dem__allow_unstable": True}
    with pytest.raises(UnstableError, match="no longer finite"):
        dem.simulate(pillar(**forced, time__duration=2.0, record__interval=1e-3))


def test_forced_step_is_taken_or_refused_never_shortened(pillar):
    """A sampling interval below the forced step is a mistake that the message names."""
    forced = {"numerics__dem__step_fraction": 1.5, "numerics__dem__allow_unstable": True}
    with pytest.raises(SceneError, match=r"record\.interval"):
        dem.simulate(pillar(**forced))
