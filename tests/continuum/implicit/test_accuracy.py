"""Implicit steps against the exact discrete response, theory, exact bars, and explicit steps."""

import numpy as np
import pytest
from scipy.linalg import eigh

from closed_forms import generalised_alpha as theory
from jointwave.cases.material.calibrate import calibrate
from jointwave.compare.exact.bar import images
from jointwave.compare.exact.bar.bars import JOINTED
from jointwave.continuum.build import critical_step_of, discretise, operators
from jointwave.continuum.implicit.balance import implicit_matrices
from jointwave.continuum.implicit.generalised_alpha import scheme
from tests.continuum.conftest import take

RICKER = {"load": {"shape": "ricker", "amplitude": 1e6, "period": 0.01}}
ACROSS = {"motion__rotation": "none", "load__direction": [0.6, 0.8, 0.0]}


def modes(run):
    """Return frequencies [n], rad/s, and shapes [freedoms, n] of unit modal mass of a run's linear
    rock and joints."""
    matrices, free = implicit_matrices(run.discrete.body), run.implicit.stepper.free
    stiffness = operators(run.discrete)[0][free][:, free].toarray()
    square, shapes = eigh(stiffness, matrices.mass[free][:, free].toarray())
    # Rigid motion has the round-off of the highest frequency.
    omega = np.sqrt(np.where(square < 1e-12 * square[-1], 0.0, square))
    full = np.zeros((run.state.u.size, omega.size))
    full[free] = shapes
    return omega, full


def misfit(found, expected):
    return np.linalg.norm(found - expected) / np.linalg.norm(expected)


LINEAR = {
    "undamped": {},
    "dashpots": {"joints__damping_ratio": 0.05},
    "fixed": {"ends__end": "fixed"},
    "across": ACROSS,
    "consistent": {
        "numerics__continuum__mass": "consistent",
        "numerics__continuum__cell": "simplex",
        "load__direction": [0.6, 0.8, 0.0],
    },
}


@pytest.mark.parametrize("rho", [0.0, 0.5, 0.9, 1.0])
@pytest.mark.parametrize("kind", LINEAR)
def test_a_linear_run_is_the_exact_discrete_response(short, implicit, noise, kind, rho):
    """Every mode under a load of noise, a hundred steps: to the round-off of the modes, whose
    frequencies are known to 1e-16 of the highest, 1e4 times the lowest."""
    scene = short(time__duration=5e-3, record__interval=5e-5, **LINEAR[kind])
    run = implicit(scene, rho, dim=2 if kind == "consistent" else None, change=noise(100)).go()
    omega, shapes = modes(run)
    loaded = run.model.ends.loaded
    force = np.outer(shapes[loaded.freedom].T @ loaded.share, loaded.pressure)
    eta = run.discrete.properties.time_constant or 0.0
    motion = theory.response(scheme(rho), omega, force, run.clock.dt, eta * omega / 2)
    state, last = run.state, shapes @ np.array([q[:, -1] for q in motion]).T
    for found, expected in zip(
        (state.u, state.v, run.implicit.now.acceleration), last.T, strict=True
    ):
        assert misfit(found, expected) < 1e-9


@pytest.mark.parametrize("rho", [0.5, 0.8, 1.0])
def test_a_mode_has_the_period_and_the_damping_of_theory(pillar, implicit, rho):
    """The second longitudinal mode of the free bar, omega = 2 pi c / L, 12 steps a period. Order 4
    leaves 1e-10 of the frequency; the first steps let the third root die out."""
    scene = pillar(
        pillar__length=5.0,
        time__duration=0.04,
        record={
            "stress": [1.0],
            "velocity": [0.0],
            "interval": 5.0 / calibrate(pillar()).bar_speed / 12,
        },
        numerics__continuum__order=4,
        load__amplitude=0.0,
    )
    run = implicit(scene, rho, kind="equivalent")
    p, body = run.discrete.properties, run.discrete.body
    run.state.v[body.freedom(np.arange(len(body.y)), 0)] = np.cos(2 * np.pi * body.y / 5.0)
    q = run.go().samples.displacement[0]
    skip = 60 if rho < 1 else 0
    before, at, after = q[skip:-2], q[skip + 1 : -1], q[skip + 2 :]
    # q'' = trace q' - product q of the two principal roots.
    (trace, product), *_ = np.linalg.lstsq(np.stack([at, -before], axis=1), after, rcond=None)
    found = np.log(np.roots([1, -trace, product])[0])
    x = 2 * np.pi * p.bar_speed / 5.0 * run.clock.dt
    expected = theory.frequency(scheme(rho), x)
    assert abs(found.imag) == pytest.approx(expected.imag, rel=1e-8)
    assert found.real == pytest.approx(expected.real, abs=1e-9)
    longer = x / abs(found.imag) - 1
    assert longer == pytest.approx(theory.period_error(scheme(rho), x), rel=1e-6)
    assert 0.01 < longer < 0.05


@pytest.mark.parametrize("rho", [0.6, 1.0])
@pytest.mark.parametrize("kind", [{}, {"joints__damping_ratio": 0.02, "ends__end": "matched"}])
def test_error_falls_with_the_square_of_the_step(pillar, implicit, rho, kind):
    """A smooth pulse against the exact jointed bar; stress at a joint and inside a block,
    velocity."""
    errors = []
    for interval in (8e-5, 4e-5):
        scene = pillar(
            **RICKER,
            **kind,
            time__duration=0.04,
            record={"stress": [20.0, 20.2], "velocity": [19.75], "interval": interval},
        )
        run, exact = implicit(scene, rho).go(), JOINTED.run(scene)
        errors.append(
            [
                misfit(run.samples.stress[:2], exact.stress.values),
                misfit(run.samples.velocity, exact.velocity.values[..., 0]),
            ]
        )
    rates = np.log2(np.divide(errors[:-1], errors[1:]))
    assert rates == pytest.approx(np.full((1, 2), 2.0), abs=0.1)


def explicit(scene, implicit, stride, kind="jointed"):
    """Return the samples of explicit steps of the same model."""
    run = implicit(scene, stride=stride, kind=kind)
    take(run.model, run.state, run.samples, stride, 0, run.clock.steps + 1)
    return run.samples


STRENGTHS = {
    "no tension": {"joints__tension": False},
    "softening": {"joints__tensile_strength": 1e5, "joints__fracture_energy": 10.0},
    "friction": {"joints__friction_angle": 30.0, **ACROSS},
    "cohesion, dashpots": {
        "joints__friction_angle": 30.0,
        "joints__cohesion": 2e5,
        "joints__residual_cohesion": 1e5,
        "joints__damping_ratio": 0.02,
        **ACROSS,
    },
}


@pytest.mark.parametrize(
    "kind",
    [
        pytest.param(
            kind, marks=pytest.mark.slow if "dashpots" in kind or kind == "friction" else ()
        )
        for kind in STRENGTHS
    ],
)
def test_implicit_and_explicit_steps_meet(pillar, implicit, kind):
    """20 m of the paper's pillar, whose joints part by millimetres behind its pulse: both err with
    the square of the step, so that their distance is a quarter at half the step; kinks in time, of
    the pulse and of joints that open or slip, may cost a part of an order."""
    scene = pillar(
        **STRENGTHS[kind],
        pillar__length=20.0,
        time__duration=0.015,
        record={"stress": [10.0], "velocity": [9.75], "interval": 5e-5},
    )
    distances = []
    for stride in (10, 20):
        ours = implicit(scene, 0.9, stride).go().samples
        theirs = explicit(scene, implicit, stride)
        distances.append(misfit(ours.velocity, theirs.velocity))
    assert distances[0] < 1e-3
    assert np.log2(distances[0] / distances[1]) > 1.4


def test_a_stiff_joint_takes_steps_of_a_hundred_critical_ones(pillar, implicit):
    """One joint 1e4 times as stiff as the others: what bounds explicit steps bounds neither
    stability nor accuracy here. Against the exact jointed bar, a pulse of 20 ms in 160 steps:
    by theory a wave of frequency 2 / T lags by (omega dt)^2 / 11 of its travel of up to 3 / 2 T,
    0.02 rad."""
    scene = pillar(
        load={"shape": "ricker", "amplitude": 1e6, "period": 0.02},
        time__duration=0.06,
        soft_layers=[{"y": 20.0, "spacing_stiffness": 4.608e13}],
        record={"stress": [20.0], "velocity": [19.75], "interval": 1.25e-4},
        numerics__continuum__order=4,
    )
    p, critical = calibrate(scene), critical_step_of(scene, discretise(scene, "jointed"), "jointed")
    assert p.own_stiffness.max() > 1e4 * p.own_stiffness.min()
    run, exact = implicit(scene, 0.9).go(), JOINTED.run(scene)
    assert run.clock.dt > 100 * critical
    assert misfit(run.samples.stress[:1], exact.stress.values) < 0.02
    assert misfit(run.samples.velocity, exact.velocity.values[..., 0]) < 0.02


def test_a_sudden_load_rings_without_dissipation_only(pillar, implicit):
    """A step load on the homogenised bar, eight steps for a wave through an element: behind the
    front the trapezoidal rule rings at the highest frequencies, rho = 0 does not."""
    scene = pillar(
        load={"shape": "step", "amplitude": 1e6},
        time__duration=0.015,
        record={"stress": [10.0], "velocity": [10.0], "interval": 2e-5},
        numerics__continuum__order=1,
    )
    exact, rough = images.solve(scene).stress.values[0], []
    for rho in (1.0, 0.5, 0.0):
        stress = implicit(scene, rho, kind="equivalent").go().samples.stress[0]
        rough.append(np.abs(np.diff(stress, 4)).max())
        assert misfit(stress, exact) < 0.1
    assert rough[0] > rough[1] > rough[2]
