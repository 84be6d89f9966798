"""The chain between rock of a quality factor: its modes in closed form, its step and its ledger."""

from types import SimpleNamespace

import numpy as np
import pytest

from jointwave import dem
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.sampling import Clock
from jointwave.compare.engines import solve
from jointwave.compare.misfit.metrics import misfit
from jointwave.dem.axial.build import build, build_model
from jointwave.dem.axial.leapfrog import march
from jointwave.dem.axial.relaxation import unrelaxed
from jointwave.dem.axial.state import state_at_rest
from jointwave.results.dataset import energy_residual
from tests.cases.material.test_constant_q import roots

Q = {"rock__quality_factor": 10.0, "rock__reference_frequency": 100.0}
DAMPED = {"joints__damping_ratio": 0.02}
STILL = {"load": {"shape": "step", "amplitude": 0.0}}
RELAXING = {
    "rock alone": {},
    "joints damped apart": DAMPED,
    "mass damping, matched ends": {
        "damping__mass_proportional": 50.0,
        "ends": {"start": "matched", "end": "quiet"},
    },
    "a layer and segments": {
        **DAMPED,
        "soft_layers": [{"y": 20.0, "spacing_stiffness": 4.375e8}],
        "segments": [
            {"y": [5.0, 10.0], "intact_modulus": 2e10, "density": 2600.0},
            {"y": [30.0, 35.0], "joints": False, "intact_modulus": 2e11},
        ],
        "ends__end": "matched",
    },
}


@pytest.mark.parametrize("damping", [{}, DAMPED], ids=["rock alone", "joints damped apart"])
@pytest.mark.parametrize("number", [1, 7, 60, 99])
def test_mode_rings_and_decays_as_the_root_of_leapfrog_says(pillar, number, damping):
    """1000 steps at half of the critical one, to 1e-9 of the start in every block; joints that are
    all alike leave the modes as they are."""
    scene = pillar(**Q, **STILL, **damping)
    p, (_, _, _, critical) = calibrate(scene), build(scene)
    dt, steps = critical / 2, 1000
    model = build_model(scene, p, Clock(dt, 1, steps))
    relaxation, state = model.relaxation, state_at_rest(model.effects, p.block_count, True)
    joint = SimpleNamespace(**{k: v[..., 0] for k, v in relaxation._asdict().items()})
    stiffness = unrelaxed(scene, p).stiffness[0] * p.area
    phase = number * np.pi / p.block_count
    x = 4 * stiffness / p.block_mass * np.sin(phase / 2) ** 2 * dt**2
    every = roots(joint, float(x), dt)
    z = every[np.argmax(every.imag)]
    mode = np.cos(phase * (np.arange(p.block_count) + 0.5))
    state.u[:] = mode
    state.v[:] = mode * (1 - 1 / z).real / dt
    before = joint.gain / dt * (z - 1) / (z - joint.decay) / z
    state.elongation[:] = np.outer(before.real, np.diff(mode))
    march(model, state, 0, steps)
    assert abs(z) < 1
    assert np.abs(state.u - mode * (z**steps).real).max() < 1e-9


@pytest.mark.parametrize("changes", RELAXING.values(), ids=RELAXING)
def test_ledger_closes_and_mechanisms_only_lose(pillar, changes):
    """What the dashpots take is booked from their own springs, and closes to round-off."""
    result = dem.simulate(pillar(**Q, **changes))
    assert energy_residual(result) < 1e-11
    lost = result["energy"].sel(term="viscous").values
    assert lost[-1] > 0 and np.diff(lost).min() >= -1e-13 * lost[-1]


@pytest.mark.parametrize("changes", [{}, DAMPED], ids=["rock alone", "joints damped apart"])
def test_chain_is_as_near_to_the_jointed_bar_as_without(pillar, changes):
    """Its distance is the dispersion of blocks, 0.06 % of waves 27 m long; the quality factor moves
    the waveform by more than a per cent."""
    load = {"shape": "ricker", "amplitude": 1e6, "period": 0.02}
    relaxes = Q | {"rock__reference_frequency": 50.0}
    scenes = [pillar(load=load, ends__end="matched", **changes, **more) for more in (relaxes, {})]
    found, elastic = (misfit(solve("dem", s), solve("jointed-bar", s)) for s in scenes)
    assert found < 1.05 * elastic < 7e-4
    assert misfit(*(solve("jointed-bar", s) for s in scenes)) > 1e-2
