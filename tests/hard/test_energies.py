"""Energy over very many steps."""

from math import sqrt

import numpy as np
import pytest

from hard_runs import EPS, SHORT, HardRun

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
