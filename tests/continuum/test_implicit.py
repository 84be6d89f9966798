"""Implicit steps against the exact discrete response, exact bars, and explicit steps."""

from typing import Any

import numpy as np
import pytest
from scipy.linalg import eigh

from closed_forms import generalised_alpha as theory
from jointwave.cases.errors import StoppedError
from jointwave.cases.material.calibrate import calibrate
from jointwave.compare.exact.bar.bars import JOINTED
from jointwave.continuum.run import simulate
from jointwave.continuum.stepping.implicit import HALVINGS, Implicit, scheme
from jointwave.continuum.stepping.problem import Held
from tests.continuum.stacked import Force, stack
from tests.continuum.test_explicit import joined, problem

RICKER = {"load": {"shape": "ricker", "amplitude": 1e6, "period": 0.01}}
ACROSS = {"motion__rotation": "none", "load__direction": [0.6, 0.8, 0.0]}


def numerics(**changes):
    """Return the keys of implicit steps."""
    return {"numerics__continuum": {"scheme": "implicit", **changes}}


def misfit(found, expected):
    return np.linalg.norm(found - expected) / np.linalg.norm(expected)


def pushed(dim, dt, eta=None, held=False):
    """Return three boxes, and joints between them, under noise on top of them."""
    body = stack(dim, 3, 2, 1)
    if eta is not None:
        body = body._replace(damping=eta * body.stiffness)
    top, below = (body.sides[name].node for name in ("top", "bottom"))
    noise = np.random.default_rng(1).standard_normal(1000)
    push = Force(
        dim * top, body.sides["top"].weight, lambda t: noise[np.rint(t / dt).astype(int)], dt
    )
    fixed = (dim * below[:, None] + np.arange(dim)).ravel()
    stays = Held(fixed, np.zeros(fixed.size)) if held else None
    return problem(body, joined(2, dim > 1, eta), top[:1], forces=push, held=stays)


@pytest.mark.parametrize("rho", [0.0, 0.5, 0.9, 1.0])
@pytest.mark.parametrize(("dim", "eta", "held"), [(1, None, False), (1, 0.1, True), (2, 0.1, True)])
def test_a_linear_run_is_the_exact_discrete_response(dim, eta, held, rho):
    """Every mode under a load of noise, a hundred steps; dashpots in proportion to springs."""
    dt = 0.2
    own = pushed(dim, dt, eta, held)
    steps = Implicit(own, dt, 1, rho)
    steps.take(0, 101, 1000)
    free, body = steps.balance.free, own.body
    square, shapes = eigh(own.stiffness[free][:, free].toarray(), np.diag(body.mass[free]))
    omega, full = (
        np.sqrt(np.abs(square) * (square > 1e-12 * square[-1])),
        np.zeros((body.mass.size, free.size)),
    )
    full[free] = shapes
    load = np.zeros((body.mass.size, 101))
    np.add.at(load, own.forces.freedom, own.forces.at(0, 101).T)
    motion = theory.response(scheme(rho), omega, full.T @ load, dt, (eta or 0.0) * omega / 2)
    for found, expected in zip((steps.now.u, steps.now.v, steps.now.a), motion, strict=True):
        assert misfit(found, full @ expected[:, -1]) < 1e-9


@pytest.mark.parametrize("rho", [0.6, 1.0])
@pytest.mark.parametrize("kind", [{}, {"joints__damping_ratio": 0.02, "ends__end": "matched"}])
def test_error_falls_with_the_square_of_the_step(pillar, rho, kind):
    """A smooth pulse against the exact jointed bar, at a joint and inside a block."""
    errors = []
    for interval in (8e-5, 4e-5):
        scene = pillar(
            **RICKER, **kind, **numerics(spectral_radius=rho, steps_per_period=10),
            pillar__length=20.0, time__duration=0.02, soft_layers=[],
            record={"stress": [10.0, 10.2], "velocity": [9.75], "interval": interval},
        )  # fmt: skip
        run, exact = simulate(scene), JOINTED.run(scene)
        assert run.attrs["dt"] == interval
        errors.append(
            [misfit(run[name].values, exact[name].values) for name in ("stress", "velocity")]
        )
    rates = np.log2(np.divide(errors[0], errors[1]))
    assert rates == pytest.approx(np.full(2, 2.0), abs=0.1)


STRENGTHS: dict[str, dict[str, Any]] = {
    "no tension": {"joints__tension": False},
    "cohesion, dashpots": {
        "joints__friction_angle": 30.0,
        "joints__cohesion": 2e5,
        "joints__residual_cohesion": 1e5,
        "joints__damping_ratio": 0.02,
        **ACROSS,
    },
}


@pytest.mark.parametrize(("kind", "fraction"), [("no tension", 0.15), ("cohesion, dashpots", 0.33)])
def test_implicit_and_explicit_steps_meet(pillar, kind, fraction):
    """Both err with the square of the step, so that their distance is a quarter at half the step;
    kinks in time, of joints that open or slip, may cost a part of an order."""
    distances = []
    for parts in (1, 2):
        own = {"steps_per_period": 2000 * parts, "step_fraction": fraction / parts}
        runs = []
        for way in ("explicit", "implicit"):
            scene = pillar(
                **STRENGTHS[kind], pillar__length=5.0, time__duration=0.008, soft_layers=[],
                record={"stress": [2.5], "velocity": [2.25], "interval": 5e-5},
                numerics__continuum=own | {"scheme": way},
            )  # fmt: skip
            runs.append(simulate(scene))
        assert runs[0].attrs["steps"] == runs[1].attrs["steps"]
        distances.append(misfit(*(one["velocity"].values for one in runs)))
    assert distances[0] < 1e-3
    assert np.log2(distances[0] / distances[1]) > 1.4


def test_a_stiff_joint_takes_steps_of_a_hundred_critical_ones(pillar):
    """One joint 1e4 times as stiff as the others: what bounds explicit steps bounds neither
    stability nor accuracy here. By theory a wave of frequency 2 / T lags by (omega dt)^2 / 11 of
    its travel of up to 3 / 2 T, 0.02 rad."""
    scene = pillar(
        load={"shape": "ricker", "amplitude": 1e6, "period": 0.02},
        pillar__length=20.0, time__duration=0.04,
        soft_layers=[{"y": 10.0, "spacing_stiffness": 4.608e13}],
        record={"stress": [10.0], "velocity": [9.75], "interval": 1.25e-4},
        **numerics(order=4, steps_per_period=10, spectral_radius=0.9),
    )  # fmt: skip
    p = calibrate(scene)
    assert p.own_stiffness.max() > 1e4 * p.own_stiffness.min()
    run, exact = simulate(scene), JOINTED.run(scene)
    assert run.attrs["dt"] > 100 * run.attrs["critical_dt"]
    assert misfit(run["stress"].values, exact["stress"].values) < 0.02
    assert misfit(run["velocity"].values, exact["velocity"].values) < 0.02


def test_a_linear_run_is_factorised_once(pillar):
    """With dashpots and half joints: one correction is enough in every step."""
    ends = {"start": "matched", "end": "quiet"}
    scene = pillar(
        pillar__length=2.0, soft_layers=[], joints__damping_ratio=0.05, ends=ends,
        time__duration=2e-3, record={"stress": [0.5], "velocity": [0.2]}, **numerics(),
    )  # fmt: skip
    about = simulate(scene).attrs
    assert about["factorisations"] == 1
    assert about["newton_iterations"] == about["steps"]


class InHalves(Implicit):
    """Steps that no whole one of converges."""

    def _step(self, n: int, begin: float, end: float) -> bool:
        return end - begin < 1 and super()._step(n, begin, end)


def test_a_run_in_halves_is_one_of_half_the_step():
    """Under the same load, linear in time within whole steps, to round-off."""
    runs = []
    for kind, share in ((InHalves, 1), (Implicit, 2)):
        own = pushed(2, 0.2, 0.1, True)
        values = own.forces

        class Linear:
            freedom = values.freedom

            def at(self, first, last, share=share, values=values):
                n = np.arange(first, last) / share
                low = np.floor(n).astype(int)
                given = values.at(0, low[-1] + 2)
                return given[low] + (n - low)[:, None] * (given[low + 1] - given[low])

        steps = kind(own._replace(forces=Linear()), 0.2 / share, 31, 0.8)
        steps.take(0, 30 * share + 1, share)
        runs.append(steps)
    halved, fine = runs
    assert halved.counts[2] == 30 and fine.counts[2] == 0
    for name in ("velocity", "displacement"):
        found, known = (getattr(one.samples, name) for one in runs)
        assert np.abs(found - known).max() < 1e-10 * np.abs(known).max()


def test_a_step_that_does_not_converge_ends_the_run_with_what_there_is(rock_mass, monkeypatch):
    joint = {"dip": 30.0, "through": [3.0, 2.0]}
    push = {"kind": "pressure", "side": "top", "shape": "sine", "period": 1e-3, "amplitude": 1e6}
    scene = rock_mass(joint, continuum={"scheme": "implicit"}, loads=[push])
    whole, step = simulate(scene), Implicit._step

    def fails(self, n, begin, end):
        return n + end <= 40 and step(self, n, begin, end)

    monkeypatch.setattr(Implicit, "_step", fails)
    with pytest.raises(StoppedError, match=r"implicit steps do not converge at t = ") as caught:
        simulate(scene)
    found, stride = caught.value.result, round(whole.attrs["steps"] / (whole.sizes["time"] - 1))
    assert found.sizes["time"] == 40 // stride + 1
    np.testing.assert_array_equal(found["velocity"], whole["velocity"][:, : 40 // stride + 1])
    assert found.attrs["halved_steps"] == HALVINGS + 1
