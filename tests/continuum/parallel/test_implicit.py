"""Implicit steps and static states that several processes share: what one finds, to round-off."""

import json

import numpy as np
import pytest
import xarray as xr

from cases.read import load_variant
from compare.engines import solve
from compare.scenes import find

SCENE = "guo-li-2002/fig-03"
SAME = 1e-10  # of the largest value of a waveform

SHORT = {
    "pillar.length": 3.0,
    "record.stress": [0.0, 0.5, 1.1],
    "record.velocity": [0.0, 1.5],
    "record.interval": 1e-4,
    "time.duration": 8e-3,
    "load.direction": [0.6, 0.8, 0.0],
    "numerics.continuum.scheme": "implicit",
}

SCENES = {
    "blocks that slip and break": {
        "numerics.continuum.dim": 3,
        "joints.friction_angle": 30.0,
        "joints.cohesion": 1e4,
        "joints.dynamic_friction_angle": 10.0,
        "joints.weakening_distance": 1e-5,
        "joints.dilation_angle": 5.0,
        "joints.dilation_distance": 1e-4,
        "joints.tensile_strength": 3e4,
        "joints.fracture_energy": 1.0,
        "ends.end": "fixed",
    },
    "dashpots, half joints, mass damping": {
        "numerics.continuum.dim": 2,
        "joints.damping_ratio": 0.02,
        "damping.mass_proportional": 50.0,
        "ends.start": "matched",
        "ends.end": "quiet",
    },
    "consistent mass": {
        "numerics.continuum.dim": 2,
        "numerics.continuum.cell": "simplex",
        "numerics.continuum.mass": "consistent",
    },
    "shaken base": {
        "motion.rotation": "none",
        "load.quantity": "velocity",
        "load.amplitude": 0.1,
        "ends.start": "fixed",
        "joints.damping_ratio": 0.02,
    },
    "explicit steps from rest under weight that makes joints slide": {
        "numerics.continuum.dim": 3,
        "numerics.continuum.order": 1,
        "numerics.continuum.elements_per_block": 1,
        "numerics.continuum.scheme": "explicit",
        "joints.tension": False,
        "joints.friction_angle": 30.0,
        "pillar.length": 1.5,
        "soft_layers": [],
        "gravity.direction": [0.28, 0.96, 0.0],
        "ends.end": "fixed",
    },
}


#: Whose kernels take a minute to compile in each number of processes.
DEAR = ("blocks that slip and break", "dashpots, half joints, mass damping", "shaken base")


@pytest.mark.parametrize(
    "scene", [pytest.param(s, marks=pytest.mark.slow if s in DEAR else ()) for s in SCENES]
)
def test_any_number_of_processes_gives_the_same_waveforms(scene, jointwave, tmp_path):
    """Newton's method ends far below what it may leave, so that sums in another order differ by
    round-off; an iterate more or less, where a residual is at the bound, changes nothing."""
    changes = {**SHORT, **SCENES[scene]}
    one = solve("continuum-jointed", load_variant(find(SCENE), "", changes))
    keys = [part for k, v in changes.items() for part in ("--set", f"{k}={json.dumps(v)}")]
    engine = ("--engine", "continuum", "--model", "jointed")
    done = jointwave(3, "run", SCENE, "--variant", "", *engine, *keys, "--out", tmp_path, "--json")
    (fact,) = json.loads(done.stdout)
    other = xr.load_dataset(fact["file"])
    assert one.attrs["scheme"] == changes["numerics.continuum.scheme"]
    assert other.attrs["processes"] == 3
    for name in ("scheme", "steps", "halved_steps"):
        assert other.attrs.get(name) == one.attrs.get(name)
    for name in one.data_vars:
        found, expected = other[name].values, one[name].values
        assert np.abs(found - expected).max() <= SAME * np.abs(expected).max()
