"""Real processes: the waveforms of one, whatever their number; one file, one message."""

import json
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from jointwave.cases.read import load_variant
from jointwave.compare.engines import solve
from jointwave.compare.scenes import find
from jointwave.continuum.explicit.critical import RESIDUAL
from jointwave.results.dataset import energy_residual
from jointwave.results.snapshots import snapshots_of

FILE = "guo-li-2002/fig-03"
SAME = 1e-10  # of the largest value of a waveform
BALANCED = 1e-11  # of the work done: round-off of some thousand steps

PILLAR = {
    "pillar.length": 3.0,
    "record.stress": [0.0, 0.5, 1.1, 3.0],
    "record.velocity": [0.0, 0.6, 1.5],
    "record.energy": True,
}

SHORT = PILLAR | {
    "record.interval": 5e-5,
    "time.duration": 2e-3,
    "load.period": 1e-3,
    "numerics.continuum.scheme": "explicit",
    "numerics.continuum.elements_per_block": 2,
}

INCLINED = {"load.direction": [0.6, 0.8, 0.0], "motion.rotation": "small"}

#: Newton's method ends far below what it may leave, so that sums in another order differ by
#: round-off; an iterate more or less, where a residual is at the bound, changes nothing.
IMPLICIT = PILLAR | {
    **INCLINED,
    "record.interval": 1e-4,
    "time.duration": 2e-3,
    "numerics.continuum.scheme": "implicit",
}

#: Cut between blocks, through blocks, through one piece; joints of all kinds on the cuts.
SCENES = {
    "bar, no tension, dashpots, mass damping, shaken base": (
        "jointed",
        {
            **SHORT,
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
            **SHORT,
            "joints.damping_ratio": 0.02,
            "segments": [
                {"y": [0.0, 0.5], "density": 5000.0, "block": 0.25},
                {"y": [0.5, 1.5], "joints": False, "intact_modulus": 2e11, "block": 0.25},
            ],
            "load.direction": [0, 1, 0],
            "ends.end": "matched",
        },
    ),
    "rock of a quality factor in the plane, cut through blocks": (
        "jointed",
        {
            **SHORT,
            **INCLINED,
            "rock.quality_factor": 10.0,
            "numerics.continuum.dim": 2,
            "ends.end": "quiet",
        },
    ),
    "plane wave in two dimensions, shaken base": (
        "equivalent",
        {
            **SHORT,
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
            **SHORT,
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
            **SHORT,
            **INCLINED,
            "numerics.continuum.dim": 3,
            "numerics.continuum.cell": "simplex",
            "numerics.continuum.order": 2,
            "joints.damping_ratio": 0.02,
            "ends.end": "quiet",
            "record.fields": 1e-3,
        },
    ),
    "implicit: blocks that slip and break": (
        "jointed",
        {
            **IMPLICIT,
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
    ),
    "implicit: dashpots, half joints, mass damping": (
        "jointed",
        {
            **IMPLICIT,
            "numerics.continuum.dim": 2,
            "joints.damping_ratio": 0.02,
            "damping.mass_proportional": 50.0,
            "ends.start": "matched",
            "ends.end": "quiet",
        },
    ),
    "implicit: consistent mass": (
        "jointed",
        {
            **IMPLICIT,
            "numerics.continuum.dim": 2,
            "numerics.continuum.cell": "simplex",
            "numerics.continuum.mass": "consistent",
        },
    ),
    "implicit: shaken base": (
        "jointed",
        {
            **IMPLICIT,
            "motion.rotation": "none",
            "load.quantity": "velocity",
            "load.amplitude": 0.1,
            "ends.start": "fixed",
            "ends.end": "quiet",
            "joints.damping_ratio": 0.02,
        },
    ),
    "explicit steps from rest under weight that makes joints slide": (
        "jointed",
        {
            **IMPLICIT,
            "numerics.continuum.dim": 3,
            "numerics.continuum.order": 1,
            "numerics.continuum.elements_per_block": 1,
            "numerics.continuum.scheme": "explicit",
            "joints.tension": False,
            "joints.friction_angle": 30.0,
            "pillar.length": 1.5,
            "time.duration": 4e-3,
            "load.period": 5e-3,
            "record.stress": [0.0, 0.5, 1.1],
            "soft_layers": [],
            "gravity.direction": [0.28, 0.96, 0.0],
            "ends.end": "fixed",
        },
    ),
}


CUT = "one piece of tetrahedra with dashpots"

#: Whose kernels take long to compile in each number of processes, and whose effects others have.
DEAR = {
    "plane wave in two dimensions, shaken base",
    "implicit: blocks that slip and break",
    "implicit: dashpots, half joints, mass damping",
    "implicit: shaken base",
}

#: Terms of the ledger that a scene is there for.
WHAT_HAPPENS = {
    "bar, no tension, dashpots, mass damping, shaken base": ["viscous", "boundary"],
    "damped segments and an intact one between them": ["viscous", "boundary"],
    "rock of a quality factor in the plane, cut through blocks": ["viscous", "boundary"],
    "plane wave in two dimensions, shaken base": ["friction", "boundary"],
    "blocks in space that slip and break": ["friction", "fracture", "boundary"],
    CUT: ["viscous", "boundary"],
    "implicit: blocks that slip and break": ["friction", "fracture"],
    "implicit: dashpots, half joints, mass damping": ["viscous", "boundary"],
    "implicit: consistent mass": [],
    "implicit: shaken base": ["viscous", "boundary"],
    "explicit steps from rest under weight that makes joints slide": ["friction"],
}

WAVES = {"stress", "velocity", "displacement", "shear", "rotation", "energy"}


@pytest.fixture(scope="module")
def runs(in_turn, in_toml, request, tmp_path_factory):
    """Return a function that gives a scene's result by this process and by three, which run in turn
    all scenes whose tests are selected."""
    tests = [item for item in request.session.items if item.path == request.path]
    asked = {item.callspec.params["scene"] for item in tests if hasattr(item, "callspec")} | {CUT}
    folders = {scene: tmp_path_factory.mktemp("three") for scene in SCENES if scene in asked}
    ends = in_turn(3, *(command(scene, out, in_toml) for scene, out in folders.items()))
    of_three = dict(zip(folders, ends, strict=True))

    @cache
    def of(scene):
        model, changes = SCENES[scene]
        code, printed, said = of_three[scene]
        (fact,) = json.loads(printed)
        assert code == 0 and said == []
        assert list(folders[scene].glob("*.nc")) == [Path(fact["file"])]
        one = solve(f"continuum-{model}", load_variant(find(FILE), "", changes))
        return one, xr.load_dataset(fact["file"])

    return of


def command(scene, out, in_toml):
    """Return the command that runs a scene."""
    model, changes = SCENES[scene]
    keys = [part for k, v in changes.items() for part in ("--set", f"{k}={in_toml(v)}")]
    engine = ("--engine", "continuum", "--model", model)
    return "run", FILE, "--variant", "", *engine, *keys, "--out", out, "--json"


@pytest.mark.parametrize(
    "scene", [pytest.param(s, marks=pytest.mark.slow if s in DEAR else ()) for s in SCENES]
)
def test_any_number_of_processes_gives_the_same_waveforms(scene, runs):
    """To round-off, with one file and one report; what the scene is there for does happen.

    The search for the critical step ends within half its residual, and round-off may end it
    elsewhere; explicit steps, which follow from it, are the same.
    """
    one, other = runs(scene)
    assert other.attrs["processes"] == 3
    assert one.attrs["scheme"] == SCENES[scene][1]["numerics.continuum.scheme"]
    same = RESIDUAL / 2 if one.attrs["scheme"] == "implicit" else 1e-12
    assert other.attrs["critical_dt"] == pytest.approx(one.attrs["critical_dt"], rel=same)
    for name in ("dt", "steps", "degrees_of_freedom", "scheme", "halved_steps"):
        assert other.attrs.get(name) == one.attrs.get(name)
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
