"""Steps that do not converge: taken in halves, back to whole ones, and given up at last."""

import numpy as np
import pytest

from jointwave.cases.errors import StoppedError
from jointwave.continuum import simulate
from jointwave.continuum.implicit import step as implicit_step
from jointwave.continuum.implicit.run import HALVINGS


def watched(run, refuse):
    """Let a run refuse parts of steps, and return the list of parts that it then takes.

    refuse : function of (step, share, halvings). A part is (step, share at its end, halvings).
    """
    taken, step = [], run.implicit.stepper.step

    def one(n, share, halvings):
        outcome = step(n, share, halvings)
        if refuse(n, share, halvings):
            return outcome._replace(converged=False)
        taken.append((n, share, halvings))
        return outcome

    run.implicit.stepper.step = one
    return taken


def test_halves_end_on_the_clock_and_make_way_again(short, implicit):
    """Step 2 is refused but in quarters until its middle, where a half will do."""
    run = implicit(short())
    taken = watched(run, lambda n, share, k: n == 2 and k < (2 if share <= 0.5 or k == 0 else 1))
    run.implicit.run(1, 0, 5)
    assert taken == [
        (0, 1.0, 0),
        (1, 1.0, 0),
        (2, 0.25, 2),
        (2, 0.5, 2),
        (2, 1.0, 1),
        (3, 1.0, 0),
    ]
    assert run.implicit.halvings == 2
    assert run.implicit.counts[1] == 4


DAMPED = {"joints__damping_ratio": 0.05}
ENDS = {
    "matched": DAMPED | {"ends__start": "matched", "ends__end": "quiet"},
    "mass damping": DAMPED | {"ends__end": "fixed", "damping": {"mass_proportional": 50.0}},
    "shaken": DAMPED
    | {
        "load": {"shape": "ricker", "amplitude": 0.1, "period": 0.002, "quantity": "velocity"},
        "ends__start": "fixed",
    },
    "opening": {"joints__tension": False},
}


@pytest.mark.parametrize("kind", ENDS)
def test_a_run_in_halves_is_one_of_half_the_step(short, implicit, kind):
    """Under the same load, linear in time within whole steps; to round-off, however the ends
    absorb, and to what the last residual leaves where joints open."""
    whole = implicit(short(**ENDS[kind]), 0.8)

    def same_motion(model):
        if model.ends.loaded is not None:
            pressure = whole.model.ends.loaded.pressure
            steps = np.arange(2 * pressure.size - 1) / 2
            finer = np.interp(steps, np.arange(pressure.size), pressure)
            loaded = model.ends.loaded._replace(pressure=finer)
            return model._replace(ends=model.ends._replace(loaded=loaded))
        return model

    fine = implicit(short(**ENDS[kind]), 0.8, stride=2, change=same_motion)
    if kind == "shaken":
        follow(fine, whole)
    taken = watched(whole, lambda n, share, halvings: halvings == 0)
    whole.go()
    fine.go()
    assert {halvings for _, _, halvings in taken} == {1}
    scale = np.abs(fine.samples.velocity).max()
    assert np.abs(whole.samples.velocity - fine.samples.velocity).max() < 1e-9 * scale
    stress = np.abs(fine.samples.stress).max()
    assert np.abs(whole.samples.stress - fine.samples.stress).max() < 1e-8 * stress


def follow(fine, whole):
    """Give the fixed of a run at half the step the motion of the whole one at its halves."""
    motion = whole.implicit.stepper.fixed.motion
    steps = np.arange(motion.shape[1])
    at = np.arange(2 * steps.size - 1) / 2
    finer = np.array([np.interp(at, steps, values) for values in motion])
    fine.implicit.stepper.fixed = fine.implicit.stepper.fixed._replace(motion=finer)


def test_simulate_hands_over_what_was_computed(short, monkeypatch):
    """The same from outside: the error carries a result like any other, up to the last sample."""
    scene = short(numerics__continuum__scheme="implicit", numerics__continuum__steps_per_period=400)
    whole, applied_at = simulate(scene), implicit_step.applied_at

    def broken(model, n, share):
        applied = applied_at(model, n, share)
        return applied if n + share <= 40 else applied._replace(pressure=np.nan)

    monkeypatch.setattr(implicit_step, "applied_at", broken)
    with pytest.raises(StoppedError) as caught:
        simulate(scene)
    result = caught.value.result
    assert result.sizes["time"] == 21  # two steps a sample
    assert (result.stress == whole.stress.isel(time=slice(21))).all()
    assert result.attrs["halved_steps"] == HALVINGS
