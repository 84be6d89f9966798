"""Criteria for joints at the edge of opening, sliding and breaking."""

from __future__ import annotations

from collections.abc import Callable
from math import inf
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from compare.experiments.robustness.case import EPS, STEP, CaseTrial, Judgement, criterion
from compare.experiments.robustness.criteria.energies import ROUND_OFF, SPENT
from compare.misfit.metrics import relative_l2
from compare.solvers.continuum import JOINTED_ROCK

if TYPE_CHECKING:
    from joints.law import Law

#: Of the work put in. Where a joint opens within a step the trapezoid of its force is off by
#: K (v dt)^2 / 8 at most; at a twentieth of the critical step that is 3e-4 of m v^2 / 2.
KINKS = 1e-3


@criterion("misfit from elastic joints under the same prestress")
def just_closed(trial: CaseTrial) -> Judgement:
    """A prestress of just the largest tension of the wave leaves every joint closed.

    The elastic pillar under the same prestress, p, gives that tension; there the traction of
    tension-free joints is zero, to round-off, and they behave like elastic ones.
    """
    joints = trial.properties.joint_y.tolist()
    clock = {"record__interval": trial.dt, "record__stress": joints, "record__velocity": []}
    free = trial.run(**clock, joints__tension=True, prestress__normal=0.0)
    p = -float(free["stress"].values.min())
    bound, barred = (
        trial.run(**clock, joints__tension=tension, prestress__normal=p)["stress"].values
        for tension in (True, False)
    )
    steps = float(free.attrs["steps"])
    return Judgement(relative_l2(barred, bound), 10 * EPS * steps, f"misfit at {p:.3g} Pa")


@criterion("misfit from a load 2^99 times as large, scaled")
def scales_by_two(trial: CaseTrial) -> Judgement:
    """Tension-free joints have no scale: a load smaller by a power of two gives the same result in
    every digit, with gaps down to 1e-40 m that open and close like those of a large one."""
    small = 2.0**-99
    one, other = (trial.run(load__amplitude=a) for a in (1.0, small))
    found = relative_l2(other["stress"].values / small, one["stress"].values)
    return Judgement(found, 0.0, f"misfit; smallest load {small:.2g} Pa")


@criterion("imbalance over the work")
def ledger(trial: CaseTrial) -> Judgement:
    """No energy is created or lost when joints open, close, slide and break."""
    from results.dataset import energy_residual

    return Judgement(energy_residual(trial.result), KINKS, _spent(trial.result))


def _spent(result: xr.Dataset) -> str:
    terms = {str(t): float(result["energy"].sel(term=t)[-1]) for t in result["term"].values}
    work = max(abs(float(x)) for x in result["energy"].sel(term="work").values) or 1.0
    parts = [f"{t} {terms[t] / work:.2g}" for t in SPENT if t in terms]
    return f"of the work; spent: {', '.join(parts)}"


@criterion("fracture energy spent over that of a joint, off a whole number")
def whole_joints(trial: CaseTrial) -> Judgement:
    """Breaking costs each joint its fracture energy, G_c times the section, and no more.

    Just short of a snap-back a joint softens over a thousandth of its opening, so none is caught on
    the way and the energy is that of a whole number of joints, of which there are N - 1.
    """
    p, energy = trial.properties, trial.scene.joints.fracture_energy or 0.0
    spent = float(trial.result["energy"].sel(term="fracture").values[-1])
    joints = spent / (energy * p.area)
    if not 0.5 < joints < p.block_count - 0.5:
        return Judgement(inf, KINKS, f"{joints:.3g} of {p.block_count - 1} joints")
    return Judgement(abs(joints - round(joints)), KINKS, f"of a joint; {round(joints)} broke")


@criterion("misfit from a joint that cannot slide, at a cohesion equal to the largest shear")
def just_held(trial: CaseTrial) -> Judgement:
    """At a cohesion equal to the largest shear a joint sticks, just below it slides.

    A joint of any cohesion tells the largest shear; at that and an eps each step the run is the
    same and friction has done no work. At a thousandth less it has. Implicit steps are the same to
    round-off: an iterate on the way may slide where the step does not.
    """
    (layer,) = trial.scene.soft_layers
    # The joint is recorded at every step, for any step.
    every_step = {"record__interval": float(trial.result.attrs["dt"]), STEP: 1.0}

    def run(cohesion: float) -> xr.Dataset:
        layers = [{"y": layer.y, "cohesion": cohesion}]
        return trial.run(soft_layers=layers, record__stress=[layer.y], **every_step)

    free = run(1e12)
    peak = float(np.abs(free["shear"].values).max())
    held, slid = run(peak * (1 + KEEP)), run(peak * (1 - 1e-3))
    work = [float(r["energy"].sel(term="friction").values[-1]) for r in (held, slid)]
    found = relative_l2(held["shear"].values, free["shear"].values)
    if not (work[0] == 0 and work[1] > 0):
        return Judgement(inf, 0.0, f"friction work {work[0]:.3g} and {work[1]:.3g} J")
    bound = ROUND_OFF * float(held.attrs["steps"]) if trial.is_implicit else 0.0
    return Judgement(found, bound, f"misfit; a thousandth below it friction takes {work[1]:.2g} J")


KEEP = 1e-12


@criterion("spurious traction, Pa")
def one_ulp(trial: CaseTrial) -> Judgement:
    """A gap of the smallest float is open and carries no traction; the same closure carries one."""
    stiffness, traction = _normal_law(trial)
    least = float(np.finfo(float).tiny)
    wrong = [traction(least, 0.0)]
    for closed in (-least, -1e-9, np.nextafter(-1e-9, 0.0)):
        wrong.append(traction(closed, 0.0) + stiffness * closed)
    wrong.append(traction(least, -1e9))
    return Judgement(float(np.abs(wrong).max()), 0.0, "Pa, of gaps of 2e-308 and 1e-9 m")


def _normal_law(trial: CaseTrial) -> tuple[float, Callable[[float, float], float]]:
    """Return the first joint's stiffness (Pa/m) in the solver, and its traction (Pa) as a function
    of gap (m) and its rate (m/s)."""
    from joints.law import law_of, parts_of, table_of
    from joints.normal import normal_traction

    joints = _joint_law(trial)
    first, parts = law_of(table_of(joints), 0), parts_of(joints)
    return first.normal_stiffness, lambda gap, rate: normal_traction(first, parts, gap, rate, 0.0)


def _joint_law(trial: CaseTrial) -> Law:
    if trial.engine.has_rigid_blocks:
        from dem.axial.model import law_of_joints

        return law_of_joints(trial.properties)
    from continuum.build import discretise

    interface = discretise(trial.scene, str(JOINTED_ROCK.model)).joints
    assert interface is not None
    return interface.law
