"""The energy ledger of implicit steps: closed to round-off where every force is linear."""

import numpy as np
import pytest

from closed_forms import generalised_alpha as theory
from jointwave.cases.material.calibrate import calibrate
from jointwave.continuum.implicit.generalised_alpha import scheme
from jointwave.continuum.state import TERMS
from jointwave.results.dataset import imbalance

OBLIQUE = {"load__direction": [0.6, 0.8, 0.0]}
ACROSS = OBLIQUE | {"motion__rotation": "none"}
DAMPED = {"joints__damping_ratio": 0.05}
SIMPLICES = {"numerics__continuum__mass": "consistent", "numerics__continuum__cell": "simplex"}
SHAKEN = {
    "load": {"shape": "ricker", "amplitude": 0.1, "period": 0.002, "quantity": "velocity"},
    "ends__start": "fixed",
}
LINEAR = {
    "undamped": (1, {}),
    "damped": (1, DAMPED | {"ends__start": "matched", "ends__end": "quiet"}),
    "mass damping": (1, DAMPED | {"ends__end": "fixed", "damping": {"mass_proportional": 50.0}}),
    "weight": (
        1,
        {
            "gravity": {"direction": [0.0, 1.0, 0.0], "static": False},
            "prestress": {"normal": 1e6},
            "ends__end": "fixed",
        },
    ),
    "shaken": (1, DAMPED | SHAKEN),
    "across": (1, DAMPED | ACROSS | {"ends__end": "matched"}),
    "plane": (2, DAMPED | OBLIQUE | {"ends__end": "quiet"}),
    "simplices": (2, DAMPED | OBLIQUE | SIMPLICES | {"ends__end": "quiet"}),
    "space": (3, DAMPED | OBLIQUE | {"ends__end": "quiet"}),
}


@pytest.mark.parametrize("kind", LINEAR)
def test_trapezoidal_rule_keeps_the_ledger_of_a_linear_scene(short, implicit, kind):
    """rho = 1: mean force times displacement in every step is what kinetic and elastic energy,
    dashpots and ends have of it, identically."""
    dim, tables = LINEAR[kind]
    run = implicit(short(**tables), 1.0, dim=dim).go()
    assert np.abs(run.energy("kinetic")).max() > 0
    assert imbalance(run.samples.energy, TERMS) < 1e-10


NONLINEAR = {
    "no tension": {"joints__tension": False},
    "softening": {"joints__tensile_strength": 1e5, "joints__fracture_energy": 10.0},
    "friction": {"joints__friction_angle": 30.0, **ACROSS},
    "cohesion, dashpots": {
        "joints__friction_angle": 30.0,
        "joints__cohesion": 2e5,
        "joints__residual_cohesion": 1e5,
        **DAMPED,
        **ACROSS,
    },
}


@pytest.mark.parametrize("kind", NONLINEAR)
def test_ledger_of_a_strength_closes_with_the_step(pillar, implicit, kind):
    """Trapezoids miss what happens within the step in which a joint opens or breaks, of the
    order of dt^2; sliding is closed by itself, whose work is the trapezoid of its own force."""
    left = []
    for stride in (1, 4):
        scene = pillar(
            time__duration=0.02,
            record__interval=1e-4,
            **{"record__stress": [20.0]},
            **NONLINEAR[kind],
        )
        run = implicit(scene, 1.0, stride).go()
        left.append(imbalance(run.samples.energy, TERMS))
        spent = {"softening": "fracture", "no tension": "kinetic"}.get(kind, "friction")
        assert run.energy(spent)[-1] > 1e-3 * run.energy("work")[-1]
    if spent == "friction":
        assert max(left) < 1e-9
    else:
        assert left[0] < 1e-4 and left[1] < left[0] / 4


def test_dissipation_of_the_scheme_is_that_of_theory(short, implicit):
    """A mode of a free bar at 12 steps a period, rho = 0.6: energy falls as |z|^2 of theory, and
    the ledger misses just that."""
    scene = short(
        load__amplitude=0.0,
        record={
            "stress": [1.0],
            "velocity": [0.0],
            "interval": 5.0 / calibrate(short()).bar_speed / 12,
        },
        numerics__continuum__order=4,
    )
    run = implicit(scene, 0.6, kind="equivalent")
    p, body = run.discrete.properties, run.discrete.body
    run.state.v[body.freedom(np.arange(len(body.y)), 0)] = np.cos(2 * np.pi * body.y / 5.0)
    run.go()
    whole = run.energy("kinetic") + run.energy("elastic")
    x = 2 * np.pi * p.bar_speed / 5.0 * run.clock.dt
    decay = 2 * theory.frequency(scheme(0.6), x).real
    assert decay < -1e-3
    # Twelve steps are nearly one period, after which the shape of the motion is the same.
    found = np.log(whole[36:-24] / whole[12:-48]) / 24
    assert found == pytest.approx(decay, rel=0.02)
