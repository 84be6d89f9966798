"""The first steps of two rigid blocks, worked out by hand.

Slabs of 1 m and 1000 kg/m2 over 4 m2, E_eq = 2.5 MPa and nu = 1/4: K'_n = 2.5e6 Pa/m, K'_s = 1e6
Pa/m, a bar speed of 50 m/s and so Z = 5e4 Pa s/m. A step load of 1000 Pa and steps of 0.01 s: one
adds 1e-5 m/s for each Pa, and the mean of the load over the first is 500 Pa."""

from math import sqrt

import numpy as np
import pytest

from jointwave import dem
from jointwave.cases.schema.scene import Scene

STEP = {"shape": "step", "amplitude": 1000.0}
TERMS = ("kinetic", "elastic", "viscous", "boundary", "work")


def scene(samples=3, **tables):
    """Return the two blocks, with tables put in place of their own."""
    own = {
        "title": "by hand",
        "pillar": {"length": 2.0, "side": 2.0, "block": 1.0},
        "rock": {"density": 1000.0, "equivalent_modulus": 2.5e6, "equivalent_poisson": 0.25},
        "load": STEP,
        "time": {"duration": 0.01 * (samples - 1)},
        "record": {"stress": [0.0, 0.5, 1.0, 2.0], "velocity": [0.5, 1.5], "interval": 0.01},
        "numerics": {"dem": {"step_fraction": 0.6}},
    }
    return Scene.model_validate(own | tables)


def run(**tables):
    """Return the result of the rigid blocks, in steps of 0.01 s."""
    result = dem.simulate(scene(**tables))
    assert result.attrs["dt"] == 0.01
    return result


@pytest.fixture(params=["chain", "none", "small", "finite"])
def engine(request, plain):
    """Return a function that runs the blocks as a chain, or in space with each kind of rotation, of
    which there is none: the load is so near the axis that it only calls for all freedoms."""
    if request.param == "chain":
        return run

    def in_space(load=STEP, **tables):
        load = load | {"direction": [1e-20, 1.0, 0.0]}
        return run(load=load, motion={"rotation": request.param}, **tables)

    return in_space


def holds(values, expected):
    """Hold an array to numbers, at round-off."""
    np.testing.assert_allclose(values, expected, rtol=1e-12, atol=1e-15)


def along(variable):
    """Return the component along the pillar, [receiver, sample]."""
    return variable.sel(axis="y").values


def closes(result):
    """Hold a ledger to its sum: what the load puts in is found in the other terms."""
    energy = result.energy.values
    holds(energy[:-1].sum(axis=0), energy[-1])


def test_free_blocks(engine):
    """f = 0, 125, 437.5 N; v0 = 5e-3, 1.375e-2, 1.9375e-2, v1 = 0, 1.25e-3, 5.625e-3 m/s."""
    result = engine()
    holds(along(result.displacement), [[0, 5e-5, 1.875e-4], [0, 0, 1.25e-5]])
    holds(along(result.velocity), [[2.5e-3, 9.375e-3, 1.65625e-2], [0, 6.25e-4, 3.4375e-3]])
    holds(result.stress, [[500, 1000, 1000], [250, 562.5, 718.75], [0, 125, 437.5], [0, 0, 0]])


def test_ledger_of_free_blocks(engine):
    """m v v' / 2, f g / 2, and the load's mean of two steps times dt times the speed between."""
    energy = engine().energy
    assert tuple(energy.term.values) == TERMS
    kinetic = [0, 2000 * 5e-3 * 1.375e-2, 2000 * (1.375e-2 * 1.9375e-2 + 1.25e-3 * 5.625e-3)]
    elastic = [0, 500 * 5e-5 / 2, 1750 * 1.75e-4 / 2]
    work = [0, 30 * 5e-3, 30 * 5e-3 + 40 * 1.375e-2]
    holds(energy, [kinetic, elastic, [0, 0, 0], [0, 0, 0], work])


def test_dashpot_sees_the_rate_extrapolated_to_the_step(engine):
    """C = K eta = 2.5e3: 125 + 2.5e3 * 7.5e-3 = 143.75 N at the first step; then the rates are
    v1 - v0 = 1.4375e-3 - 1.35625e-2 = -1.2125e-2 and -5e-3, extrapolated to -1.56875e-2."""
    ratio = 0.5e-3 * sqrt(2500.0)  # eta = 1e-3 s
    result = engine(joints={"damping_ratio": ratio})
    u0 = 5e-5 + 1.35625e-4
    second = 2.5e6 * (u0 - 1.4375e-5) + 2.5e3 * 1.56875e-2
    holds(along(result.displacement), [[0, 5e-5, u0], [0, 0, 1.4375e-5]])
    holds(result.stress.sel(stress_y=1.0), [0, 143.75, second])
    viscous = 75 * 0.005 * 5e-3, 0.02 * (18.75 + 2.5e3 * 1.56875e-2) * 1.2125e-2
    # By steps: half a step of 75 N at 5 mm/s, then the mean of both forces over a whole one.
    holds(result.energy.sel(term="viscous"), [0, viscous[0], viscous[0] + viscous[1]])


def test_quiet_end(engine):
    """r = 5e4 (v + v') / 2: 25 N as v1 comes to 1 mm/s, then 128.75 N on the way to 4.15 mm/s."""
    result = engine(ends={"end": "quiet"})
    holds(along(result.displacement), [[0, 5e-5, 1.875e-4], [0, 0, 1e-5]])
    holds(along(result.velocity)[1], [0, 5e-4, 2.575e-3])
    holds(result.stress.sel(stress_y=2.0), [0, 25, 128.75])
    boundary = 0.02 * (25 + 128.75) * 1e-3
    holds(result.energy.sel(term="boundary"), [0, 0, boundary])


def test_fixed_end(engine):
    """The half block's spring, 5e6 N/m, answers 1.25e-5 m with 62.5 N."""
    result = engine(ends={"end": "fixed"})
    holds(along(result.velocity)[1], [0, 6.25e-4, (1.25e-3 + 5e-3) / 2])
    holds(result.stress.sel(stress_y=2.0), [0, 0, 62.5])


def test_prestress_of_a_fixed_end(engine):
    """2 Pa close its spring of 5e6 Pa/m by 0.4 um, and nothing moves."""
    for place in ("start", "end"):
        load = {"shape": "step", "amplitude": 0.0}
        load |= {"quantity": "velocity"} if place == "start" else {}
        result = engine(samples=2, load=load, ends={place: "fixed"}, prestress={"normal": 2.0})
        holds(result.stress, np.full((4, 2), 2.0))
        assert np.abs(along(result.velocity)).max() < 1e-15


def test_work_of_a_prestress(engine):
    """100 Pa on 4 m2 push block 0 and hold block 1: 400 N times what the joint closes by."""
    result = engine(prestress={"normal": 100.0})
    holds(along(result.velocity), along(engine().velocity))
    work = [0, 0.15 + 400 * 5e-5, 0.15 + 0.55 + 400 * 1.75e-4]
    holds(result.energy.sel(term="work"), work)
    elastic = result.energy.sel(term="elastic").values
    holds(elastic - elastic[0], [0, 400 * 5e-5 + 0.0125, 400 * 1.75e-4 + 1750 * 1.75e-4 / 2])


def test_matched_end(engine):
    """z = 5e4 behind 5e6 N/m: the lag is dt k / 2z = 1/2, the gain dt / 1.5, w = 1.25e-3 / 150."""
    result = engine(ends={"end": "matched"})
    holds(result.stress.sel(stress_y=2.0), [0, 0, 5e6 * 1.25e-3 / 150])


def test_mass_damping(engine):
    """alpha = 20: a = 0.1, v' = (0.9 v + 1e-5 F) / 1.1."""
    result = engine(samples=2, damping={"mass_proportional": 20.0})
    first = 5e-3 / 1.1
    second = (0.9 * first + 1e-5 * (1000 - 2.5e6 * 0.01 * first)) / 1.1
    holds(along(result.velocity)[0], [first / 2, (first + second) / 2])
    closes(result)
    assert result.energy.sel(term="viscous")[-1] > 0


def test_local_damping(engine):
    """0.8 of what would add to a speed is lost, nothing of what sets a block in motion."""
    result = engine(damping={"local": 0.8})
    v0, v1 = [0.0, 5e-3, 6.75e-3, 8.225e-3], [0.0, 0.0, 1.25e-3, 1.775e-3]
    holds(along(result.velocity), [np.convolve(v, [0.5, 0.5], "valid") for v in (v0, v1)])
    closes(result)


def test_no_tension(engine):
    """The load pulls: the joint opens and carries nothing."""
    load = {"shape": "step", "amplitude": -1000.0}
    result = engine(load=load, joints={"tension": False})
    holds(along(result.displacement), [[0, -5e-5, -2e-4], [0, 0, 0]])
    holds(result.stress.sel(stress_y=1.0), [0, 0, 0])


def test_sudden_gravity_and_prestress(engine):
    """10 m/s2 along y: v = -0.05 half a step before, 0.05 half a step behind; 2 Pa all over."""
    result = engine(
        samples=2,
        load={"shape": "step", "amplitude": 0.0},
        gravity={"direction": [0.0, 1.0, 0.0], "acceleration": 10.0, "static": False},
        prestress={"normal": 2.0},
    )
    holds(along(result.velocity), [[0, 0.1], [0, 0.1]])
    holds(result.stress, np.full((4, 2), 2.0))
    gap = along(result.displacement)[1] - along(result.displacement)[0]
    holds(gap - gap[0], [0, 0])


def test_a_shaken_base(engine):
    """0.1 m/s: 1 mm a step. The half block's spring closes by 1 mm, then by 2 - 0.5 mm: 5000 and
    7500 N, less 1250 N of the joint on the way to 112.5 mm/s."""
    load = {"shape": "step", "amplitude": 0.1, "quantity": "velocity"}
    result = engine(samples=3, load=load, ends={"start": "fixed"})
    holds(along(result.velocity)[0], [0, 0.025, (0.05 + 0.1125) / 2])
    holds(result.stress.sel(stress_y=0.0), [0, 5000, 7500])
    # 2e4 and 3e4 N over 1 mm a step; 2e7 N/m of the half block's spring, 1e7 N/m of the joint.
    holds(result.energy.sel(term="work"), [0, 10, 35])
    stored = result.energy.sel(term=["elastic", "boundary"]).sum("term")
    holds(stored, [0, 10, 22.5 + 1.25])
    closes(result)


def test_shear_of_blocks_that_do_not_turn():
    """K'_s = 1e6: f = 50 N at the first step, on the far side; v0 = 1.45e-2, v1 = 5e-4."""
    load = {"shape": "step", "amplitude": 1000.0, "direction": [1.0, 0.0, 0.0]}
    result = run(samples=2, load=load, motion={"rotation": "none"})
    holds(result.velocity.sel(axis="x"), [[2.5e-3, 9.75e-3], [0, 2.5e-4]])
    holds(result.shear.sel(across="x"), [[500, 1000], [250, 525], [0, 50], [0, 0]])
    holds(result.stress, np.zeros((4, 2)))


def test_shear_of_blocks_that_turn():
    """I = 4000 (4 + 1) / 12; the load turns block 0 by 1000 N m, to 6 mrad/s; its far face goes
    by u + phi x r = 5e-5 - 6e-5 / 2: 20 Pa. The face bends by 2.5e6 * 4 / 3 * 6e-5 N m."""
    load = {"shape": "step", "amplitude": 1000.0, "direction": [1.0, 0.0, 0.0]}
    result = run(samples=3, load=load)
    holds(result.shear.sel(across="x", stress_y=1.0)[:2], [0, 20])
    ways = [[0, 5e-5, 5e-5 + 0.01 * 1.48e-2], [0, 0, 2e-6]]
    holds(result.displacement.sel(axis="x"), ways)
    first = 6e-3 + 6e-6 * (2000 + 40 - 200)
    turns = [[0, 6e-5, 6e-5 + 0.01 * first], [0, 0, 0.01 * 6e-6 * (200 + 40)]]
    holds(result.rotation.sel(axis="z"), turns)
    holds(result.rotation.sel(axis=["x", "y"]), np.zeros((2, 3, 2)))


def test_twist():
    """A couple of 4000 N m along y: I = 4000 * 4 / 6; the face's polar moment is 8 / 3 m4."""
    load = {"shape": "step", "amplitude": 1000.0, "arm": 1.0}
    result = run(samples=3, load=load)
    spin = 3.75e-6 * 2000
    turn = 0.01 * spin
    back = 1e6 * 8 / 3 * turn
    expected = [0, turn, turn + 0.01 * (spin + 3.75e-6 * (4000 - back))]
    holds(result.rotation.sel(axis="y"), [expected, [0, 0, 0.01 * 3.75e-6 * back]])


def test_eccentric_load():
    """0.25 m off along x: 500 N m about z in the first half step."""
    load = {"shape": "step", "amplitude": 1000.0, "at": [0.25, 0.0]}
    result = run(samples=2, load=load)
    holds(result.rotation.sel(axis="z")[0], [0, 0.01 * 6e-6 * 500])
    load["at"] = [0.0, 0.25]
    result = run(samples=2, load=load)
    holds(result.rotation.sel(axis="x")[0], [0, -0.01 * 6e-6 * 500])
