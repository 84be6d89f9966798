"""Every engine stops a run that leaves its bounds, says so in one line, and keeps what is sound."""

import re

import pytest

from jointwave import continuum, dem
from jointwave.cases.errors import StoppedError
from jointwave.compare.engines import solver
from jointwave.numerics.divergence import EVERY

ABOVE = 1.001  # of the critical step: (x + sqrt(x^2 - 1))^2 = 1.09 times as large in every step
ACROSS = {"load__direction": [0.6, 0.8, 0.0], "joints__friction_angle": 30.0}
ACROSS |= {"numerics__allow_large_motion": True}  # which is exceeded before the bounds
SMALL = {"pillar__length": 10.0, "record__stress": [5.0], "record__velocity": [5.0]}

KINDS = {
    "chain": ({}, "dem"),
    "fourth order": ({"numerics__dem__scheme": "fourth-order"}, "dem"),
    "space": (ACROSS, "dem"),
    "threads": ({**ACROSS, "numerics__dem__threads": 2}, "dem"),
    "rock": ({"numerics__continuum__scheme": "explicit"}, "continuum"),
}


@pytest.fixture(params=KINDS)
def forced(request, pillar):
    """Return a function of a duration in steps that simulates with steps above the critical one,
    each of them a sample."""
    changes, engine = KINDS[request.param]
    is_dem, changes = engine == "dem", {**SMALL, **changes}
    prepared = solver("dem" if is_dem else "continuum-jointed").prepare(pillar(**changes))
    step, numerics = ABOVE * prepared.critical, {"step_fraction": ABOVE, "allow_unstable": True}
    changes |= {f"numerics__{engine}__{key}": value for key, value in numerics.items()}
    solve = dem.simulate if is_dem else continuum.simulate
    return lambda n: solve(pillar(**changes, record__interval=step, time__duration=step * n))


def test_what_is_sound_is_kept_and_nothing_else(forced):
    """The kept samples are, bit for bit, those of a run that ends there, which nothing stops."""
    with pytest.raises(StoppedError, match=r"toml: .* diverged at t = .* s, step \d+ of .* s") as e:
        forced(1000)
    kept = e.value.result
    assert re.fullmatch(r".*set numerics\.\w+\.step_fraction to at most 0\.9", str(e.value))
    samples = kept.sizes["time"]
    whole = forced(samples - 1)
    for name in ("stress", "velocity", "displacement", "energy"):
        assert kept[name].identical(whole[name]), name
    stopped = int(str(e.value).split("step ")[1].split()[0])
    assert stopped - EVERY - 1 <= samples - 1 < stopped
