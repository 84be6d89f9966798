"""Implicit steps against the exact discrete response and explicit steps; their order against exact
waves is that of `test_constant_q.py`."""

import numpy as np
import pytest
from scipy.linalg import eigh

from closed_forms import generalised_alpha as theory
from jointwave.cases.errors import StoppedError
from jointwave.cases.loads import late_by
from jointwave.compare.misfit.metrics import relative_l2
from jointwave.continuum.run import simulate
from jointwave.continuum.stepping.implicit import HALVINGS, Implicit, scheme
from jointwave.continuum.stepping.problem import Held
from tests.continuum.bodies import PUSH
from tests.continuum.stacked import Force, joined, problem, stack

STEP = 0.2


def pushed(dim, dt, eta=None, held=False):
    """Return three boxes, and joints between them, under noise on top of them, linear in STEP."""
    body = stack(dim, 3, 2, 1)
    if eta is not None:
        body = body._replace(damping=eta * body.stiffness)
    top, below = (body.sides[name].node for name in ("top", "bottom"))
    noise = np.random.default_rng(1).standard_normal(1000)
    every = STEP * np.arange(1000)
    push = Force(dim * top, body.sides["top"].weight, lambda t: np.interp(t, every, noise), dt)
    fixed = (dim * below[: len(below) * held, None] + np.arange(dim)).ravel()
    stays = Held(fixed, np.zeros((fixed.size, 0)))
    return problem(body, joined(2, dim > 1, eta), top[:1], forces=push, held=stays)


@pytest.mark.parametrize("rho", [0.0, 0.5, 0.9, 1.0])
@pytest.mark.parametrize(("dim", "eta", "held"), [(1, None, False), (2, 0.1, True)])
def test_a_linear_run_is_the_exact_discrete_response(dim, eta, held, rho, plain):
    """Every mode under a load of noise, a hundred steps; dashpots in proportion to springs."""
    own = pushed(dim, STEP, eta, held)
    steps = Implicit(own, STEP, 1, rho)
    steps.take(0, 101, 1000)
    free, body = steps.balance.free, own.body
    square, shapes = eigh(own.stiffness[free][:, free].toarray(), np.diag(body.mass[free]))
    omega = np.sqrt(np.abs(square) * (square > 1e-12 * square[-1]))
    full, load = np.zeros((body.mass.size, free.size)), np.zeros((body.mass.size, 101))
    full[free] = shapes
    np.add.at(load, own.forces.freedom, own.forces.at(0, 101).T)
    motion = theory.response(scheme(rho), omega, full.T @ load, STEP, (eta or 0.0) * omega / 2)
    for found, expected in zip((steps.now.u, steps.now.v, steps.now.a), motion, strict=True):
        assert relative_l2(found, full @ expected[:, -1]) < 1e-9


@pytest.mark.parametrize("rho", [0.0, 0.25, 0.5, 0.9, 1.0])
def test_radius_is_kept_at_infinity_and_never_exceeded(rho):
    """The characteristic polynomial at infinity is (z + rho)^3; round-off of its triple root would
    be its cube root, so it is the polynomial that is compared."""
    found = np.poly(theory.amplification(scheme(rho), 1e7))
    assert found == pytest.approx(np.poly([-rho] * 3), abs=1e-12)
    x = np.logspace(-3, 5, 200)
    assert theory.spectral_radius(scheme(rho), x).max() <= 1 + 1e-8


def test_implicit_and_explicit_steps_meet(pillar):
    """Both err with the square of the step, so that their distance is a quarter at half the step;
    kinks in time, of joints that open, may cost a part of an order. Joints that slip are held to
    exact waves, `verification/test_sliding_joints.py`."""
    distances = []
    for parts in (1, 2):
        own = {"steps_per_period": 2000 * parts, "step_fraction": 0.15 / parts}
        runs = []
        for way in ("explicit", "implicit"):
            scene = pillar(
                joints__tension=False, pillar__length=6.0, time__duration=0.008, soft_layers=[],
                record={"stress": [2.5], "velocity": [2.25], "interval": 5e-5},
                numerics__continuum=own | {"scheme": way},
            )  # fmt: skip
            runs.append(simulate(scene))
        assert runs[0].attrs["steps"] == runs[1].attrs["steps"]
        distances.append(relative_l2(*(one["velocity"].values for one in runs)))
    assert distances[0] < 1e-3
    assert np.log2(distances[0] / distances[1]) > 1.4


def test_a_linear_run_is_factorised_once(pillar):
    """With dashpots and half joints: one correction is enough in every step, and none is needed
    before the load has come through the half joint."""
    ends = {"start": "matched", "end": "quiet"}
    scene = pillar(
        pillar__length=2.0, soft_layers=[], joints__damping_ratio=0.05, ends=ends,
        prestress={"normal": 1e5},
        time__duration=2e-3, record={"stress": [0.5], "velocity": [0.2]},
        numerics__continuum__scheme="implicit",
    )  # fmt: skip
    about = simulate(scene).attrs
    assert about["factorisations"] == 1
    waits = int(late_by(scene, "jointed") / about["dt"])
    assert about["newton_iterations"] == about["steps"] - waits > 0


class InHalves(Implicit):
    """Steps that no whole one of converges."""

    def _step(self, n: int, begin: float, end: float) -> bool:
        return end - begin < 1 and super()._step(n, begin, end)


def test_a_run_in_halves_is_one_of_half_the_step():
    """Under the same load, linear within the whole steps, to round-off."""
    runs = []
    for kind, share in ((InHalves, 1), (Implicit, 2)):
        steps = kind(pushed(2, STEP / share, 0.1, True), STEP / share, 31, 0.8)
        steps.take(0, 30 * share + 1, share)
        runs.append(steps)
    halved, fine = runs
    assert halved.counts[2] == 30 and fine.counts[2] == 0
    for name in ("velocity", "displacement"):
        found, known = (getattr(one.samples, name) for one in runs)
        assert np.abs(found - known).max() < 1e-10 * np.abs(known).max()


def test_a_step_that_does_not_converge_ends_the_run_with_what_there_is(rock_mass, monkeypatch):
    joint = {"dip": 30.0, "through": [3.0, 2.0]}
    scene = rock_mass(joint, continuum={"scheme": "implicit"}, loads=[PUSH])
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
