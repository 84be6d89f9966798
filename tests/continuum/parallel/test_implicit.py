"""Implicit steps that several processes share: what one process finds, to round-off."""

import json

import numpy as np
import pytest
import xarray as xr

SCENE = "guo-li-2002/fig-03"
#: Of the largest value of a waveform: the residual that Newton's method may leave, over some
#: hundred steps.
SAME = 1e-8

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
}


@pytest.mark.parametrize("scene", SCENES)
def test_any_number_of_processes_takes_the_same_steps(scene, jointwave, tmp_path):
    """The same corrections and factorisations, and the same waveforms."""
    changes = {**SHORT, **SCENES[scene]}
    keys = [part for k, v in changes.items() for part in ("--set", f"{k}={json.dumps(v)}")]
    results = []
    for count in (1, 3):
        out = ("--out", tmp_path / str(count), "--json")
        engine = ("--engine", "continuum", "--model", "jointed")
        done = jointwave(count, "run", SCENE, "--variant", "", *engine, *keys, *out)
        (fact,) = json.loads(done.stdout)
        results.append(xr.load_dataset(fact["file"]))
    one, three = results
    assert (one.attrs["processes"], three.attrs["processes"]) == (1, 3)
    assert one.attrs["scheme"] == three.attrs["scheme"] == "implicit"
    for name in ("steps", "newton_iterations", "factorisations", "halved_steps"):
        assert three.attrs[name] == one.attrs[name]
    for name in one.data_vars:
        found, expected = three[name].values, one[name].values
        assert np.abs(found - expected).max() <= SAME * np.abs(expected).max()
