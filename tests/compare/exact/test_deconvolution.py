"""A free end's motion gives back the wave that came up to the start."""

import numpy as np
import pytest
import xarray as xr

from jointwave.cases.errors import SceneError
from jointwave.cases.histories import Gabor
from jointwave.cases.read import load_tables
from jointwave.compare.engines import solve
from jointwave.compare.readings.deconvolution import deconvolve

PERIOD, CYCLES = 0.01, 3
PULSE = Gabor(0.02, PERIOD, CYCLES)


def column(direction=(0, 1, 0), **tables):
    """Return a column below a free end, with the pulse coming up."""
    load = {"shape": "gabor", "amplitude": 0.02, "period": PERIOD, "cycles": CYCLES}
    rock = {"density": 2400.0, "p_speed": 2200.0, "s_speed": 800.0}
    return load_tables(
        {
            "title": "a column",
            "pillar": {"length": 10.0, "side": 0.5, "block": 0.25},
            "rock": rock | tables.pop("rock", {}),
            "motion": {"rotation": "none"},
            "load": load | {"quantity": "velocity", "direction": list(direction)},
            "ends": {"start": "quiet", "end": "free"},
            "time": {"duration": 0.25},
            "record": {"velocity": [10.0], "interval": 1e-4},
            **tables,
        }
    )


def recovered(scene, solver):
    """Return the incident motion from a solver's surface motion, and the pulse."""
    found = deconvolve(scene, solve(solver, scene).velocity[0, :, 0])
    return found.values, PULSE.value(found.time.values)


ROCK = {"equivalent-bar": {}, "jointed-bar": {"intact_modulus": 8.64e10}}
SOFT = {"soft_layers": [{"y": 5.0, "spacing_stiffness": 4e8}]}


@pytest.mark.parametrize("tables", [{}, SOFT, {"joints": {"damping_ratio": 0.1}} | SOFT])
@pytest.mark.parametrize("solver", ROCK)
def test_the_exact_bar_gives_back_the_pulse(solver, tables):
    """Of which it knows 1e-8, and the deconvolution more where joints pass less; where the record
    ends, the rock still moves."""
    found, pulse = recovered(column(rock=ROCK[solver], **tables), solver)
    whole = len(found) // 2
    assert np.abs(found - pulse)[:whole].max() < 2e-7 * PULSE.amplitude
    assert np.abs(found - pulse).max() < 3e-5 * PULSE.amplitude


LAYERS = [
    {"y": [0.0, 2.5], "density": 2700.0, "p_speed": 4000.0, "s_speed": 2000.0},
    {"y": [6.0, 10.0], "density": 1900.0, "p_speed": 900.0, "s_speed": 400.0, "block": 0.2},
]


@pytest.mark.parametrize("more", [{}, {"scatter": {"spacing": 0.2, "compliance": 0.3, "seed": 3}}])
@pytest.mark.parametrize("solver", ROCK)
def test_layers_give_back_the_pulse(solver, more):
    """Early by what a wave takes through each of them; the start's rock is that below it. The soft
    layer still moves where the record ends."""
    scene = column(rock=ROCK[solver], motion={}, segments=LAYERS, **more)
    found, pulse = recovered(scene, solver)
    assert np.abs(found - pulse)[: len(found) // 2].max() < 3e-5 * PULSE.amplitude


def test_a_sheared_column_gives_back_what_rigid_blocks_were_given():
    """Beside what their quiet end returns, tan(k d / 4) of what comes down, and
    pi^3 N (d / lambda)^2 / 3 of phase over the N = 2.5 waves up and down; a wave is 32 blocks
    long."""
    scene = column((1, 0, 0), **SOFT)
    found, pulse = recovered(scene, "dem")
    bound = np.tan(np.pi / 64) + np.pi**3 * 2.5 / 32**2 / 3
    assert np.linalg.norm(found - pulse) < bound * np.linalg.norm(pulse)


def test_a_water_level_holds_noise_back():
    """Rock with 39 joints stops high frequencies, whose noise would be all that is left."""
    scene = column(rock=ROCK["jointed-bar"])
    surface = solve("jointed-bar", scene).velocity[0, :, 0]
    noise = 1e-5 * np.random.default_rng(0).standard_normal(surface.size)
    held, free = (deconvolve(scene, surface + noise, level) for level in (1e-2, 0.0))
    pulse = PULSE.value(held.time.values)
    assert np.abs(held - pulse).max() < 0.02 * PULSE.amplitude
    assert not np.abs(free - pulse).max() < PULSE.amplitude


FREE = {"ends": {"start": "free", "end": "free"}, "load": {"shape": "step", "amplitude": 1.0}}
RECORD = xr.DataArray(np.zeros(3), {"time": [0.0, 0.1, 0.2]})


@pytest.mark.parametrize(
    "tables, record, words",
    [
        (FREE, RECORD, "cannot be deconvolved: the ends are not quiet and free"),
        ({"joints": {"tension": False}}, RECORD, "deconvolved: a joint carries no tension"),
        ({}, RECORD.expand_dims("velocity_y"), "must be over time only"),
    ],
)
def test_a_column_that_is_not_linear_and_several_records_are_refused(tables, record, words):
    with pytest.raises(SceneError, match=words):
        deconvolve(column(**tables), record)
