"""Rock masses that several real processes share: what one finds, to round-off."""

import json
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from jointwave.cases.read import load
from jointwave.compare.solvers.incident import incident
from jointwave.continuum.explicit.critical import RESIDUAL
from jointwave.continuum.simulate import simulate
from jointwave.results.snapshots import snapshots_of

#: Of the largest value of a waveform: sums of some thousand steps in another order; with friction
#: and fracture, too. Newton's method ends far below what it may leave, 1e-10 of the forces.
SAME = 1e-12
SUMMED = 1e-10  # of the largest energy: of elastic ones, of which what rigid motion adds cancels

WAVES = {"velocity", "displacement", "stress", "traction", "gap", "slip"}

#: One joint that an S wave meets beyond the critical angle, of which the whole field is known; sets
#: that slip, break and damp around a loaded opening, under in-situ stress; blocks at rest under
#: their weight between periodic sides, of two rocks, whose base is shaken, with joints along the
#: sides in one of them; the one joint under pressure, whose friction follows the rate of its slip.
SCENES = """
title = "Rock that several processes share"

[domain]
size = [12.0, 10.0]
least_width = 0.3

[rock]
density = 2600.0
intact_modulus = 5.0e10
intact_poisson = 0.25

[[joint_sets]]
name = "one"
dip = 30.0
through = [6.0, 5.0]
normal_stiffness = 2.0e10
shear_stiffness = 8.0e9

[[waves]]
kind = "S"
direction = [-0.6, 0.8]
shape = "sine"
amplitude = 1.0e6
period = 2.5e-3

[boundaries]
left = "quiet"
right = "quiet"
bottom = "quiet"
top = "quiet"

[time]
duration = 4.0e-3

[record]
points = [[3.0, 7.5], [6.0, 2.0], [12.0, 6.0]]
joints = [[3.3, 3.4], [8.7, 6.6]]
interval = 1.0e-4

[numerics]
continuum.size = 1.0
continuum.scheme = "explicit"

[[variants]]
name = "tunnel"
boundaries.top = "free"
prestress = { xx = 2.0e5, yy = 3.0e5 }
record.fields = 5.0e-4
time.duration = 2.0e-3

[variants.domain]
non_convex = "cut"
openings = [[[5.0, 4.0], [7.0, 4.0], [7.0, 5.5], [6.0, 6.5], [5.0, 5.5]]]

[[variants.joint_sets]]
name = "bed"
dip = 20.0
spacing = 2.0
scatter = 0.2
seed = 3
normal_stiffness = 2.0e10
shear_stiffness = 8.0e9
friction_angle = 35.0
cohesion = 1.0e5
tensile_strength = 5.0e4
fracture_energy = 1.0

[[variants.joint_sets]]
name = "cross"
dip = -60.0
spacing = 3.0
normal_stiffness = 2.0e10
shear_stiffness = 8.0e9
damping_ratio = 0.02

[[variants.loads]]
kind = "pressure"
opening = 0
shape = "sine"
amplitude = 5.0e5
period = 1.0e-3

[[variants]]
name = "weight"
waves = []
boundaries = { left = "periodic", right = "periodic", bottom = "fixed", top = "free" }
gravity = { acceleration = 9.81 }
numerics.continuum.scheme = "implicit"
time.duration = 2.0e-3

[[variants.regions]]
name = "cover"
through = [0.0, 7.0]
density = 2200.0
intact_modulus = 2.0e10

[[variants.joint_sets]]
name = "bed"
dip = 0.0
spacing = 2.0
normal_stiffness = 2.0e10
shear_stiffness = 8.0e9

[[variants.joint_sets]]
name = "cross"
dip = 90.0
spacing = 3.0
regions = ["cover"]
normal_stiffness = 2.0e10
shear_stiffness = 8.0e9

[[variants.loads]]
kind = "base"
side = "bottom"
direction = [0.6, 0.8]
quantity = "velocity"
shape = "sine"
amplitude = 0.01
period = 5.0e-3

[[variants]]
name = "rate and state"
prestress = { xx = 2.0e6, yy = 2.0e6, xy = 8.0e5 }

[[variants.joint_sets]]
name = "one"
dip = 30.0
through = [6.0, 5.0]
normal_stiffness = 2.0e10
shear_stiffness = 8.0e9
friction_angle = 20.0
direct_effect = 0.01
evolution_effect = 0.02
critical_slip_distance = 5.0e-5
reference_rate = 1.0e-6
"""


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    """Return the file of the scenes."""
    path = tmp_path_factory.mktemp("shared") / "shared.toml"
    path.write_text(SCENES)
    return path


@pytest.mark.parametrize("count", [pytest.param(2, marks=pytest.mark.slow), 3])
def test_any_number_of_processes_gives_the_same_waveforms(count, file, in_turn, tmp_path):
    """To round-off, whatever enters and however it is stepped; one process reads a receiver that
    is on rock of two, and each has its own part of the sides. Slow in two, which share as three
    do: their cuts lie elsewhere."""
    names = [] if count == 3 else ["--variant", ""]
    jointed = "--engine", "continuum", "--model", "jointed"
    command = ("run", file, *names, *jointed, "--out", tmp_path, "--json")
    ((code, out, _),) = in_turn(count, command)
    facts = json.loads(out)
    scenes = load(file)[: len(facts)]
    assert code == 0
    assert len(facts) == (4 if count == 3 else 1)
    for fact, scene in zip(facts, scenes, strict=True):
        found = xr.load_dataset(Path(fact["file"]))
        alone = simulate(scene, incident=incident(scene))
        assert found.attrs["processes"] == count
        for name in ("dt", "steps", "degrees_of_freedom", "scheme"):
            assert found.attrs[name] == alone.attrs[name]
        assert found.attrs["critical_dt"] == pytest.approx(alone.attrs["critical_dt"], rel=RESIDUAL)
        assert set(found.variables) == set(alone.variables)
        alike(found["energy"], alone["energy"], SUMMED)
        for name in WAVES & set(found.data_vars):
            alike(found[name], alone[name])
        if scene.record.fields is not None:
            one, other = snapshots_of(alone), snapshots_of(found)
            assert (one.block == other.block).all()
            for name in ("points", "displacement", "velocity"):
                alike(*(getattr(s, name)[..., s.cells, :] for s in (other, one)))


def alike(found, expected, bound=SAME):
    """Assert that values differ by round-off alone, relative to the largest."""
    assert found.shape == expected.shape
    assert np.abs(found - expected).max() <= bound * np.abs(expected).max()
