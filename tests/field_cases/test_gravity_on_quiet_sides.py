"""A column whose quiet base bears gravity (cb-geo/mpm PR 703, MOOSE 18233, Kratos 11107).

Without a wave nothing moves, and the stress at a depth z is rho g z, rho g H at the base. With one,
a scene of linear joints is the sum of that state and of the scene without gravity. Gravity that
acts suddenly leaves a quiet base where it was: it bears R = M g from the start, so that what its
dashpots take is the momentum of the column, zero at first and in the end, and its velocity has no
integral. Until a wave returns from the top its stress is (R + Z g t) / 2: the up-going wave
Z (v + g t) meets R - Z v."""

import numpy as np
import pytest

from jointwave import load, simulate
from tests.field_cases.scenes import ENGINES, SIDES, mass

RHO, G, H = 2500.0, 9.81, 20.0
WEIGHT = RHO * G * H

PILLAR = {
    "title": "a column on a quiet base",
    "pillar": {"length": H, "side": 1.0, "block": 1.0},
    "rock": {
        "density": RHO, "equivalent_modulus": 1e9, "equivalent_poisson": 0.25,
        "intact_modulus": 4e9,
    },
    "load": {"shape": "ricker", "amplitude": 1e5, "period": 0.05},
    "ends": {"start": "free", "end": "matched"},
    "gravity": {"direction": [0.0, 1.0, 0.0]},
    "time": {"duration": 0.12},
    "record": {"stress": [0.0, 5.0, H], "velocity": [0.5, H - 0.5]},
    "numerics": {"dem": {"static_tolerance": 1e-12}},
}  # fmt: skip

SETS = [
    {"name": str(dip), "dip": dip, "spacing": 1.0, "normal_stiffness": 4e9, "shear_stiffness": 2e9}
    for dip in (0.0, 90.0)
]
ROCK = mass(
    *(3.0, H),
    rock={"density": RHO, "intact_modulus": 4e9, "intact_poisson": 0.0},
    joint_sets=SETS,
    boundaries=dict.fromkeys(SIDES[:3], "quiet"),
    loads=[PILLAR["load"] | {"kind": "pressure", "side": "top"}],
    gravity={},
    time={"duration": 0.12},
    record={"points": [[1.5, H - 0.5], [1.5, H - 5.5], [1.5, 0.5]], "joints": [[1.5, 1.0]]},
    numerics={"dem": {"static_tolerance": 1e-12}, "continuum": {"size": 1.0}},
)

CASES = {f"pillar-{solver}": (PILLAR, solver) for solver in (*ENGINES, "lattice")}
CASES |= {f"rock-{solver}": (ROCK, solver) for solver in ENGINES}
every = pytest.mark.parametrize(("scene", "solver"), CASES.values(), ids=CASES)


def run(scene, solver, **changes):
    return simulate(load(scene, changes=changes), solver)


def quiet(scene):
    """Return the changes that leave out the scene's wave."""
    return {"loads": []} if "loads" in scene else {"load.amplitude": 0.0}


def pressing(result):
    """Return the stress along gravity [place, time], Pa."""
    stress = result.stress.values
    return stress[..., 1] if stress.ndim == 3 else stress


@every
def test_static_state_stays_and_adds_to_a_wave(scene, solver):
    """The static tolerance of blocks is 1e-12 of the weight, which is some 5 of the wave's stress;
    the last digits of stresses of 5e5 Pa in steps of 1e-4 s move more."""
    still, wave = run(scene, solver, **quiet(scene)), run(scene, solver, gravity=None)
    both, peak = run(scene, solver), np.abs(wave.velocity.values).max()
    assert np.abs(still.velocity.values).max() < 1e-10 * peak
    assert np.abs((both.velocity - wave.velocity).values).max() < 2e-10 * peak
    added = pressing(both) - pressing(still)[:, :1] - pressing(wave)
    assert np.abs(added).max() < 1e-8 * 1e5
    depth = [H - y for _, y in scene["record"]["points"]] if "loads" in scene else [0.0, 5.0, H]
    assert pressing(still)[:, 0] == pytest.approx(RHO * G * np.array(depth), rel=2e-6, abs=1e-2)


@every
def test_sudden_gravity_does_not_sink(scene, solver):
    """The base is back where it was; what the deepest receiver has settled is half a block's share.

    The sides of the rock are free: quiet ones would hold it back by their own dashpots."""
    changes = {**quiet(scene), "gravity.static": False, "time.duration": 0.3}
    changes |= {"boundaries": {"bottom": "quiet"}} if "loads" in scene else {}
    fallen = run(scene, solver, **changes)
    depth = H - 0.5 if "loads" in scene else H
    assert pressing(fallen)[-1, -1] == pytest.approx(RHO * G * depth, rel=0.03)
    u = fallen.displacement.values
    along = np.abs(u[:, :, min(1, u.shape[2] - 1)])
    assert along[-1, -1] < 0.03 * along[0, -1]


def test_base_of_a_falling_bar_gives_way_as_its_dashpot_does():
    """Z = sqrt(E rho); c = 632 m/s: no wave comes back before H / c = 31.6 ms."""
    fallen = run(PILLAR, "continuum-equivalent", **quiet(PILLAR), **{"gravity.static": False})
    t, impedance = fallen.time.values, np.sqrt(1e9 * RHO)
    before = (t > 0.01) & (t < 0.03)
    expected = (WEIGHT + impedance * G * t) / 2
    assert fallen.stress.values[-1][before] == pytest.approx(expected[before], rel=0.01)


@pytest.mark.parametrize("solver", ["dem", "spatial-lattice"])
@pytest.mark.parametrize("static", [True, False])
def test_matched_end_bears_a_row_across_its_axis(solver, static, plain):
    """A cantilever of weight M g leans on its matched end: shear M g / A there, from the start."""
    changes = quiet(PILLAR) | {
        "pillar.length": 5.0, "record.stress": [5.0], "record.velocity": [0.5],
        "gravity.direction": [1.0, 0.0, 0.0], "gravity.static": static, "time.duration": 0.02,
    }  # fmt: skip
    leaning = run(PILLAR, solver, **changes)
    assert leaning["shear"].values[0, 0, 0] == pytest.approx(RHO * G * 5.0, rel=1e-6)
    assert static == (np.abs(leaning.velocity.values).max() < 1e-9)


OBLIQUE = [SETS[0] | {"name": str(dip), "dip": dip, "spacing": 2.1} for dip in (38.0, -55.0)]
AS_WALLS = {
    "cantilever": (
        PILLAR | {"gravity": {"direction": [0.6, 0.8, 0.0], "acceleration": 0.5}},
        {"ends.end": "quiet"},
        {"ends.end": "fixed"},
    ),
    "rock": (
        ROCK | {"joint_sets": OBLIQUE, "domain": {"size": [9.0, 8.0]}}
        | {"record": {"points": [[4.5, 0.3], [0.3, 4.0]], "joints": [[4.5, 0.1], [3.7, 0.2]]}},
        {},
        {"boundaries": {"bottom": "fixed", "left": "roller", "right": "roller"}},
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", AS_WALLS)
def test_quiet_sides_bear_the_weight_of_blocks_as_walls_do(case):
    """Below the rock as fixed sides, beside it as rollers: half a block of rock lies before both.
    So joints between two blocks on a quiet side carry the weight, too."""
    scene, absorbing, walls = AS_WALLS[case]
    changes = quiet(scene) | {"time.duration": 0.01, "numerics.dem.static_tolerance": 1e-9}
    one, other = (run(scene, "dem", **changes, **own) for own in (absorbing, walls))
    for name in ("stress", "traction") if "loads" in scene else ("displacement", "rotation"):
        scale = float(abs(other[name]).max())
        np.testing.assert_allclose(one[name], other[name], rtol=0, atol=1e-5 * scale)
    if "loads" in scene:
        assert (one.traction.sel(joint_axis="n") > 0.1 * RHO * G * 8.0).all()


@pytest.mark.parametrize("engine", ENGINES)
def test_a_wave_enters_whole_through_a_base_whose_joints_the_weight_has_closed(engine):
    """K d_m is a twentieth of the stress of the weight, at which joints are (1 + 20.8)^2 times as
    stiff as at first. The wave comes from a base that is as stiff, not from one of open joints,
    and reaches half a block above it before anything returns. The rock at the base has a twentieth
    of the density of what lies above."""
    height, heavy, amplitude = 40.0, 40.0, 1e-4
    bed = SETS[0] | {"normal_stiffness": 1e9, "maximum_closure": RHO * heavy * height / 20.8e9}
    scene = load(
        mass(
            *(1.0, height),
            rock=ROCK["rock"] | {"density": RHO / 20},
            regions=[{"name": "above", "through": [0.5, 10.0], "density": RHO}],
            joint_sets=[bed],
            boundaries={"left": "periodic", "right": "periodic", "bottom": "quiet"},
            gravity={"acceleration": heavy},
            prestress={"xx": 0.0, "yy": 0.0},
            loads=[
                {"kind": "base", "side": "bottom", "direction": [0.0, 1.0], "quantity": "velocity"}
                | {"shape": "half-sine", "amplitude": amplitude, "period": 0.004}
            ],
            time={"duration": 0.003},
            record={"points": [[0.5, 0.5]], "interval": 1e-4},
            numerics={"continuum": {"size": 1.0}},
        )
    )
    moved = simulate(scene, engine).velocity.sel(axis="y").values[0]
    assert moved.max() == pytest.approx(amplitude, rel=0.02)
