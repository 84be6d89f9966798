"""Very many steps, at the critical one and far above it: no speed or energy grows, none drifts."""

from math import sqrt

import numpy as np
import pytest
from scipy.integrate import trapezoid

from hard_runs import EPS, EXPLICIT, ROCK, SHORT, HardRun, marked
from jointwave.cases.loads import load_history
from jointwave.cases.sampling import sample_times

#: A blow with its peak at 1 kHz, above the cut-off of 860 Hz, so that all modes ring.
BLOW = {"load.period": 1e-3, "numerics.continuum.elements_per_block": 1}
LEAPFROG = [one for one in EXPLICIT if one[1] != "fourth-order"]


def fastest_at_first(run):
    """Return the speed (m/s) of the lightest node after the impulse of the load's magnitude.

    A block has its whole mass on its one freedom. GLL elements of order p give 1 / (p (p + 1)) of
    theirs to a node at their end."""
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
    dt = x * run.critical
    result = run.run(step=x, record__interval=dt, time__duration=dt * steps * (1 + 1e-9))
    assert result.attrs["dt"] == pytest.approx(dt, rel=1e-12)
    speed = np.abs(np.diff(result["displacement"].values, axis=1)).max() / result.attrs["dt"]
    gain = 2.0 * steps if x == 1 else 1 / sqrt(1 - x * x)
    assert speed <= gain * fastest_at_first(run)


@pytest.mark.parametrize(("engine", "scheme"), marked([x for x in ROCK if x[1] == "implicit"]))
def test_implicit_steps_far_above_the_critical_never_add_energy(engine, scheme):
    """The generalised-alpha method is unconditionally stable and its modes only decay: once the
    load has ended, the most of the second half of the run is no more than that of the first, up to
    round-off of every step."""
    long = {"record.interval": 2e-3, "time.duration": 5.0}
    long["numerics.continuum.steps_per_period"] = 0.5
    run = HardRun(engine, scheme, BLOW | long)
    assert run.dt > 10 * float(run.result.attrs["critical_dt"])
    energy = run.result["energy"].sel(term=["kinetic", "elastic"]).sum("term").values
    after = energy[run.result["time"].values > 3e-3]
    half = after.size // 2
    assert after[half:].max() / after[:half].max() <= 1 + 1e-14 * run.steps


MILLION, HUNDRED_THOUSAND = 1_000_000, 100_000
TINY = {
    "load.period": 1e-3,
    "pillar.length": 2.0,
    "record.stress": [1.0],
    "record.velocity": [],
    "numerics.continuum.elements_per_block": 1,
    "numerics.continuum.spectral_radius": 1.0,
}
BRICKS = {
    "domain.size": [4.0, 2.0],
    "boundaries": {"bottom": "periodic", "top": "periodic"},
    "waves": [],
    "loads": [
        {"kind": "force", "quantity": "force", "at": [1.2, 0.7], "direction": [0.8, 0.6]}
        | {"shape": "ricker", "amplitude": 1e6, "period": 1e-3}
    ],
    "record": {"points": [[1.2, 0.7]]},
    "numerics.continuum.size": 2.0,
}
SHORT_PILLAR, BRICKWORK = (TINY, SHORT), (BRICKS, "rock-mass/brickwork")
LONG = {
    "blocks": ("dem", "leapfrog", SHORT_PILLAR, MILLION),
    "blocks, fourth order": ("dem", "fourth-order", SHORT_PILLAR, MILLION),
    "rock": ("continuum-jointed", "explicit", SHORT_PILLAR, MILLION),
    "homogenised rock": ("continuum-equivalent", "explicit", SHORT_PILLAR, MILLION),
    "slow: implicit steps": ("continuum-jointed", "implicit", SHORT_PILLAR, HUNDRED_THOUSAND),
    "bricks": ("dem", "leapfrog", BRICKWORK, MILLION),
    "slow: bricks of rock": ("continuum-jointed", "explicit", BRICKWORK, HUNDRED_THOUSAND),
}


def trend_of(run, steps):
    """Return the linear trend of kinetic and elastic energy over these steps at 0.9 of the critical
    one, over their mean; and the standard deviation of the trend by round-off and by the fit."""
    dt, period = 0.9 * run.critical, 1e-3
    changes = {"record__interval": steps // 1000 * dt, "time__duration": steps * dt * (1 + 1e-9)}
    if run.scheme == "implicit":
        changes["numerics__continuum__steps_per_period"] = period / dt
    result = run.run(step=0.9, **changes)
    energy = result["energy"].sel(term=["kinetic", "elastic"]).sum("term").values
    after = result["time"].values > 3 * period
    x = result["time"].values[after] / result["time"].values[-1]
    found = energy[after] / energy[after].mean() - 1
    slope = np.polynomial.Polynomial.fit(x, found, 1)
    swing = float(np.std(found - slope(x)))
    walk = EPS * (steps / 4 if run.scheme == "implicit" else sqrt(steps))
    return abs(float(slope(1.0) - slope(0.0))), walk + sqrt(12 / len(x)) * swing


@pytest.mark.parametrize(
    ("engine", "scheme", "scene", "steps"),
    [
        pytest.param(*one, id=name, marks=[pytest.mark.slow] if name.startswith("slow") else [])
        for name, one in LONG.items()
    ],
)
def test_energy_of_undamped_rock_has_no_trend(engine, scheme, scene, steps):
    """Leapfrog conserves its discrete energy exactly, the composition of fourth order and the
    trapezoidal rule likewise an energy near it: what is recorded may swing, by what each sample
    shows, but not drift. Each step rounds velocities and displacements by half an eps, at random: a
    walk of sqrt(N) steps of eps at most, of which four standard deviations are allowed. A linear
    trend through n samples that swing by s is uncertain by sqrt(12 / n) s; four of these too.
    Implicit steps solve with factors of a matrix that is wrong by an eps, the same in every step:
    theirs may add up to eps a step."""
    trend, deviation = trend_of(HardRun(engine, scheme, *scene), steps)
    assert trend <= 4 * deviation


def test_dashpots_of_almost_nothing_have_a_trend():
    """At a damping ratio of 1e-12 more is lost in a hundred thousand steps than by round-off."""
    leaky = HardRun("dem", "leapfrog", TINY | {"joints.damping_ratio": 1e-12})
    trend, deviation = trend_of(leaky, HUNDRED_THOUSAND)
    assert trend > 4 * deviation
