"""Steps that do not converge: taken in halves, back to whole ones, and given up at last."""

import numpy as np
import pytest

from jointwave.cases.errors import StoppedError, UnstableError
from jointwave.continuum import simulate
from jointwave.continuum.implicit import step as implicit_step
from jointwave.continuum.implicit.run import HALVINGS
from jointwave.continuum.implicit.substeps import end_resistance, shortened
from jointwave.joints.ends import half_spring
from jointwave.results.arrays import arrays


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


@pytest.mark.parametrize("share", [0.5, 1 / 1024])
def test_half_joints_are_those_of_the_shorter_step(short, implicit, share):
    """As `half_spring` makes them for that step, in every entry."""
    run = implicit(short(ends__start="matched", joints__damping_ratio=0.05))
    p, dt = run.discrete.properties, run.clock.dt
    quiet = shortened(run.model, share).ends.quiet
    one = half_spring(2 * p.regular_own_stiffness, p.time_constant, p.impedance, share * dt)
    assert quiet.springs.decay == pytest.approx([one.decay], rel=1e-13)
    assert quiet.springs.gain == pytest.approx([one.gain], rel=1e-12)
    freedom, resistance = end_resistance(quiet, 7.0, share * dt)
    assert freedom.tolist() == run.model.ends.quiet.freedom.tolist()
    expected = p.area * (7.0 * one.viscosity + one.stiffness * one.gain / (share * dt))
    assert resistance == pytest.approx([expected], rel=1e-12)


def test_what_was_computed_outlives_a_step_that_is_given_up(short, implicit):
    """The load stops being a number after step 40: one line says when, the samples are kept."""
    undisturbed = implicit(short(), stride=4).go()

    def broken(model):
        pressure = model.ends.loaded.pressure.copy()
        pressure[41:] = np.nan
        loaded = model.ends.loaded._replace(pressure=pressure)
        return model._replace(ends=model.ends._replace(loaded=loaded))

    run = implicit(short(), stride=4, change=broken)
    with pytest.raises(StoppedError, match=r"do not converge at t = .* s: .* N") as caught:
        run.go()
    assert "\n" not in str(caught.value)
    assert f"t = {40 * run.clock.dt:.6g} s" in str(caught.value)
    assert run.implicit.counts[1] == 40 and run.implicit.halvings == HALVINGS
    assert (run.samples.velocity[:, :11] == undisturbed.samples.velocity[:, :11]).all()
    assert not run.samples.velocity[:, 11:].any()
    assert isinstance(caught.value, UnstableError) and caught.value.result is None


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


def test_compiling_changes_nothing(short, implicit):
    """State and samples are as before, and the run is the same to the last bit."""
    scene = short(joints__tensile_strength=1e5, joints__fracture_energy=10.0)
    plain, warm = implicit(scene), implicit(scene)
    warm.implicit.compile()
    assert not any(rows.any() for rows in arrays(warm.samples))
    plain.go(), warm.go()
    assert (plain.samples.stress == warm.samples.stress).all()
    assert (plain.samples.energy == warm.samples.energy).all()
