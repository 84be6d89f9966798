"""Steps at the critical one, where no point moves too fast; implicit steps far above it."""

from math import sqrt

import numpy as np
import pytest
from scipy.integrate import trapezoid

from hard_runs import EXPLICIT, ROCK, HardRun, marked
from jointwave.cases.loads import load_history
from jointwave.cases.sampling import sample_times

#: A blow with its peak at 1 kHz, above the cut-off of 860 Hz, so that all modes ring.
BLOW = {"load.period": 1e-3, "numerics.continuum.elements_per_block": 1}
LEAPFROG = [one for one in EXPLICIT if one[1] != "fourth-order"]


def every_step(run, fraction, steps):
    """Return the changes for one sample a step, of exactly this fraction of the critical step."""
    dt = fraction * run.critical
    return {"step": fraction, "record__interval": dt, "time__duration": dt * steps * (1 + 1e-9)}


def fastest_at_first(run):
    """Return the speed (m/s) of the lightest node after the impulse of the load's magnitude.

    A block has its whole mass on its one freedom. GLL elements of order p give 1 / (p (p + 1)) of
    theirs to a node at their end.
    """
    p, order = run.properties, run.scene.numerics.continuum.order
    times = sample_times(run.scene)
    impulse = p.area * trapezoid(np.abs(load_history(run.scene).value(times)), times)
    share = 1.0 if run.engine.has_rigid_blocks else 1 / (order * (order + 1))
    return impulse / (p.block_mass * share)


@pytest.mark.parametrize(("engine", "scheme"), LEAPFROG)
@pytest.mark.parametrize(("x", "steps"), [(0.9, 20_000), (0.999, 20_000), (1.0, 2000)])
def test_no_point_moves_faster_than_the_impulse_allows(x, steps, engine, scheme):
    """A mode of frequency omega, driven at steps k by F_k, has the velocity (leapfrog in closed
    form) v_j = (dt/m) sum F_k cos((j - k - 1/2) W dt) / cos(W dt/2), with cos(W dt/2) = sqrt(1 -
    x^2) and x = omega dt / 2. So |v| in the norm of the mass is at most I s / sqrt(1 - x^2), I the
    integral of |F| and s = 1 / sqrt(m) of the loaded point; at x = 1 the mode alternates and grows
    by at most 2 I s a step, for a number of steps that the divergence monitor allows. Velocities
    are those at half steps: means of two of them would hide a mode that alternates."""
    run = HardRun(engine, scheme, BLOW)
    result = run.run(**every_step(run, x, steps))
    assert result.attrs["dt"] == pytest.approx(x * run.critical, rel=1e-12)
    speed = np.abs(np.diff(result["displacement"].values, axis=1)).max() / result.attrs["dt"]
    gain = 2.0 * steps if x == 1 else 1 / sqrt(1 - x * x)
    assert speed <= gain * fastest_at_first(run)


@pytest.mark.parametrize(("engine", "scheme"), marked([x for x in ROCK if x[1] == "implicit"]))
def test_implicit_steps_far_above_the_critical_never_add_energy(engine, scheme):
    """The generalised-alpha method is unconditionally stable and its modes only decay: once the
    load has ended, the most of the second half of the run is no more than that of the first, up to
    round-off of every step."""
    long = {
        "numerics.continuum.steps_per_period": 0.5,
        "record.interval": 2e-3,
        "time.duration": 5.0,
    }
    run = HardRun(engine, scheme, BLOW | long)
    assert run.dt > 10 * float(run.result.attrs["critical_dt"])
    energy = run.result["energy"].sel(term=["kinetic", "elastic"]).sum("term").values
    after = energy[run.result["time"].values > 3e-3]
    half = after.size // 2
    assert after[half:].max() / after[:half].max() <= 1 + 1e-14 * run.steps
