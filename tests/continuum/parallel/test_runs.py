"""Real processes: the waveforms of one, whatever their number; one file, one message."""

import json
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from cases.read import load_variant
from compare.engines import solve
from compare.scenes import find
from results.dataset import energy_residual
from results.snapshots import snapshots_of

SCENE = "guo-li-2002/fig-03"
SAME = 1e-10  # of the largest value of a waveform
BALANCED = 1e-11  # of the work done: round-off of some thousand steps

SHORT = {
    "pillar.length": 3.0,
    "record.stress": [0.0, 0.5, 1.1, 3.0],
    "record.velocity": [0.0, 0.6, 1.5],
    "record.interval": 5e-5,
    "record.energy": True,
    "time.duration": 2e-3,
    "load.period": 1e-3,
    "numerics.continuum.scheme": "explicit",
    "numerics.continuum.elements_per_block": 2,
}

INCLINED = {"load.direction": [0.6, 0.8, 0.0], "motion.rotation": "small"}

#: Cut between blocks, through blocks, through one piece; joints of all kinds on the cuts.
SCENES = {
    "bar, no tension, dashpots, mass damping, shaken base": (
        "jointed",
        {
            "numerics.continuum.dim": 1,
            "numerics.continuum.order": 3,
            "joints.tension": False,
            "joints.damping_ratio": 0.002,
            "damping.mass_proportional": 50.0,
            "load.quantity": "velocity",
            "load.amplitude": 0.1,
            "ends.start": "fixed",
            "ends.end": "matched",
        },
    ),
    "damped segments and an intact one between them": (
        "jointed",
        {
            "joints.damping_ratio": 0.02,
            "segments": [
                {"y": [0.0, 0.5], "density": 5000.0, "block": 0.25},
                {"y": [0.5, 1.5], "joints": False, "intact_modulus": 2e11, "block": 0.1},
            ],
            "load.direction": [0, 1, 0],
            "ends.end": "matched",
        },
    ),
    "plane wave in two dimensions, shaken base": (
        "equivalent",
        {
            "numerics.continuum.dim": 2,
            "motion.rotation": "none",
            "load.quantity": "velocity",
            "time.duration": 4e-3,
            "load.amplitude": 0.1,
            "load.direction": [0.6, 0.8, 0.0],
            "ends.start": "fixed",
            "ends.end": "quiet",
            "soft_layers": [{"y": 0.5, "spacing_stiffness": 4.4e8, "cohesion": 1e4}],
        },
    ),
    "blocks in space that slip and break": (
        "jointed",
        {
            **INCLINED,
            "joints.friction_angle": 30.0,
            "joints.cohesion": 1e4,
            "joints.residual_cohesion": 1e3,
            "joints.dynamic_friction_angle": 10.0,
            "joints.weakening_distance": 1e-6,
            "joints.dilation_angle": 5.0,
            "joints.dilation_distance": 1e-5,
            "joints.tensile_strength": 3e4,
            "joints.fracture_energy": 0.3,
            "ends.start": "quiet",
            "ends.end": "quiet",
            "numerics.continuum.order": 1,
        },
    ),
    "one piece of tetrahedra with dashpots": (
        "equivalent",
        {
            **INCLINED,
            "numerics.continuum.dim": 3,
            "numerics.continuum.cell": "simplex",
            "numerics.continuum.order": 2,
            "joints.damping_ratio": 0.02,
            "ends.end": "quiet",
            "record.fields": 1e-3,
        },
    ),
}


CUT = "one piece of tetrahedra with dashpots"

#: Terms of the ledger that a scene is there for.
WHAT_HAPPENS = {
    "bar, no tension, dashpots, mass damping, shaken base": ["viscous", "boundary"],
    "damped segments and an intact one between them": ["viscous", "boundary"],
    "plane wave in two dimensions, shaken base": ["friction", "boundary"],
    "blocks in space that slip and break": ["friction", "fracture", "boundary"],
    CUT: ["viscous", "boundary"],
}

WAVES = {"stress", "velocity", "displacement", "shear", "rotation", "energy"}


@pytest.fixture(scope="module")
def runs(jointwave, without_warnings, tmp_path_factory):
    """Return a function that gives a scene's result by this process and by three, made once."""

    @cache
    def of(scene):
        model, changes = SCENES[scene]
        changes = SHORT | changes
        out = tmp_path_factory.mktemp("three")
        keys = [part for k, v in changes.items() for part in ("--set", f"{k}={in_toml(v)}")]
        engine = ("--engine", "continuum", "--model", model)
        run = ("run", SCENE, "--variant", "", *engine, *keys, "--out", out, "--json")
        done = jointwave(3, *run)
        (fact,) = json.loads(done.stdout)
        assert without_warnings(done.stderr) == []
        assert list(out.glob("*.nc")) == [Path(fact["file"])]
        one = solve(f"continuum-{model}", load_variant(find(SCENE), "", changes))
        return one, xr.load_dataset(fact["file"])

    return of


def in_toml(value):
    """Return a value as TOML spells it; tables inline."""
    if isinstance(value, list):
        return f"[{', '.join(map(in_toml, value))}]"
    if isinstance(value, dict):
        return "{" + ", ".join(f"{k} = {in_toml(v)}" for k, v in value.items()) + "}"
    return json.dumps(value)


#: Whose kernels are dear to compile in three processes, and whose effects the others have.
DEAR = "plane wave in two dimensions, shaken base"


@pytest.mark.parametrize(
    "scene", [pytest.param(s, marks=pytest.mark.slow if s == DEAR else ()) for s in SCENES]
)
def test_any_number_of_processes_gives_the_same_waveforms(scene, runs):
    """To round-off, with one file and one report; what the scene is there for does happen."""
    one, other = runs(scene)
    assert other.attrs["processes"] == 3
    assert other.attrs["critical_dt"] == pytest.approx(one.attrs["critical_dt"], rel=1e-12)
    for name in ("dt", "steps", "degrees_of_freedom"):
        assert other.attrs[name] == one.attrs[name]
    assert set(other.variables) == set(one.variables)
    for name in WAVES & set(one.variables):
        alike(other[name].values, one[name].values)
    spent = one["energy"].max("time")
    assert (spent.sel(term=WHAT_HAPPENS[scene]) > 1e-4 * spent.sel(term="work")).all()


def test_the_ledger_of_three_processes_closes(runs):
    """Shares of every energy and of every work add up to a balance that leapfrog keeps exactly."""
    assert energy_residual(runs(CUT)[1]) < BALANCED


def test_snapshots_are_those_of_one_process(runs):
    """The same nodes, each once, and the same motion of each; cells in the same order."""
    one, three = map(snapshots_of, runs(CUT))
    assert one.displacement.shape == three.displacement.shape
    assert (one.block == three.block).all() and one.time.tolist() == three.time.tolist()
    alike(three.stress, one.stress)
    for name in ("points", "displacement", "velocity"):
        found, expected = (getattr(s, name)[..., s.cells, :] for s in (three, one))
        alike(found, expected)


def alike(found, expected):
    """Assert that values differ by round-off alone, relative to the largest."""
    assert found.shape == expected.shape
    assert np.abs(found - expected).max() <= SAME * np.abs(expected).max()
