"""Energy of joints that open: no tension, softening, fracture.

Joints that carry no tension give off their shear energy as they open: a ledger that forgets it is
open by 1 to 13 % at any step, and one that is open says so. A softening joint pulled apart takes
its fracture energy once (exaDEM's traction test counts it twice): G_f times its area."""

import numpy as np
import pytest

import jointwave as jw
from jointwave.results.dataset import MOST_OPEN, energy_residual, open_ledger
from tests.field_cases.scenes import ENGINES, mass

OPENS = {"tension": False}
SOFTENS = {"tensile_strength": 1e4, "fracture_energy": 0.05}


def rock(law, rng, fraction):
    """Return rock of one joint set that a force shears and opens, tables."""
    dip, spacing = rng.uniform(20.0, 60.0), rng.uniform(3.0, 4.0)
    stiff = {"normal_stiffness": 4.12e9, "shear_stiffness": 2.5e9}
    force = {"kind": "force", "quantity": "force", "at": [2.7, 8.0], "direction": [0.6, 0.8]}
    return mass(
        *(9.0, 16.0),
        rock={"density": 2419.0, "intact_modulus": 8.77e9, "intact_poisson": 0.03},
        joint_sets=[{"name": "joint", "dip": dip, "spacing": spacing} | stiff | law],
        boundaries={"left": "quiet", "top": "quiet", "right": "fixed", "bottom": "fixed"},
        loads=[force | {"amplitude": 8e5, "shape": "ricker", "period": 6e-3}],
        time={"duration": 0.012},
        record={"points": [[3.0, 3.0]]},
        numerics={
            "dem": {"block": 2.0, "step_fraction": fraction},
            "continuum": {"scheme": "explicit", "step_fraction": fraction, "size": 4.0},
        },
    )


@pytest.mark.parametrize("law", (OPENS, SOFTENS), ids=("no tension", "softening"))
@pytest.mark.parametrize("engine", ENGINES)
def test_what_is_open_of_a_ledger_falls_faster_than_the_step(engine, law):
    """The work of a step is of third order in it where a joint does not open in that step, and of
    second where it does. Each point opens a few times a run whatever the step: what is left falls
    with its square, by 64 here, but for which of the few openings cancel; of first order by 8."""
    left = []
    for fraction in (0.5, 0.0625):
        results = []
        for seed in range(3):
            scene = jw.load(rock(law, np.random.default_rng(seed), fraction))
            results.append(jw.simulate(scene, engine))
        assert any(float(r.energy.sel(term="friction").max()) > 0.1 for r in results)
        left.append(np.sqrt(np.mean([energy_residual(r) ** 2 for r in results])))
    assert left[0] < 1e-4 and left[1] < left[0] / 10


def test_a_ledger_that_is_open_says_by_how_much():
    """Without what opening joints give off: more than 1e-3 of the largest term."""
    scene = jw.load(rock(OPENS, np.random.default_rng(0), 0.5))
    found = jw.simulate(scene, "continuum-jointed")
    assert open_ledger(found) == ""
    lost = float(found.energy.sel(term="friction").max() / found.energy.sel(term="work").max())
    said = open_ledger(found.drop_sel(term="friction"))
    assert lost > MOST_OPEN and f"open by {lost:.2g} of its largest term" in said


@pytest.mark.parametrize("engine", ENGINES)
def test_a_ledger_of_what_stays_at_rest_is_closed(engine):
    """A leaning stack of blocks about to topple: 4 J of its joints, and rock that turns along."""
    law = {"normal_stiffness": 1e12, "shear_stiffness": 1e12, "friction_angle": 45.0}
    lean = np.array([0.97 / 5, -1.0]) / np.hypot(0.97 / 5, 1.0)
    stack = mass(
        *(1.0, 6.0),
        joint_sets=[law | {"name": "bed", "dip": 0.0, "spacing": 1.0, "tension": False}],
        gravity={"direction": lean.tolist()},
        boundaries={"bottom": "fixed"},
        time={"duration": 0.01},
        record={"points": [[0.5, 5.5]]},
        numerics={"continuum": {"size": 0.25}},
    )
    found = jw.simulate(jw.load(stack), engine)
    assert open_ledger(found) == "" and energy_residual(found) < MOST_OPEN


def test_a_run_warns_of_an_open_ledger(jointwave, in_toml, tmp_path):
    """Implicit steps of much damping at few steps a period take more than any term accounts for."""
    tables = rock({}, np.random.default_rng(0), 0.5)
    damps = {"scheme": "implicit", "steps_per_period": 20, "spectral_radius": 0.0}
    tables["numerics"]["continuum"] = damps | {"size": 8.0}
    tables["record"]["interval"] = 3e-4
    (file := tmp_path / "open.toml").write_text(in_toml(tables))
    run = ["run", file, "--engine", "continuum", "--model", "jointed", "--out", tmp_path]
    for command in (run, ["compare", file]):
        assert "energy ledger is open by" in jointwave(*command).err


@pytest.mark.parametrize("engine", ENGINES)
def test_a_joint_pulled_apart_takes_its_fracture_energy_once(engine):
    """Whatever the faces do on the way: softening gives nothing back."""
    pulled = {
        "title": "one joint pulled apart",
        "pillar": {"length": 2.0, "side": 0.5, "block": 1.0},
        "rock": {"density": 2400.0, "p_speed": 2200.0, "s_speed": 800.0, "intact_modulus": 8.64e10},
        "joints": {"tensile_strength": 2e5, "fracture_energy": 50.0},
        "load": {"shape": "half-sine", "amplitude": -2e6, "period": 0.02},
        "time": {"duration": 0.03},
        "record": {"velocity": [0.5]},
    }
    spent = jw.simulate(jw.load(pulled), engine).energy.sel(term="fracture")
    assert float(spent[-1]) == pytest.approx(50.0 * 0.5**2, rel=1e-12)
