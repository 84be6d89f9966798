"""One joint that slips between two half-spaces of rock, under a plane shear wave.

The joint carries the shear stress s up to its strength tau. With the incident stress sigma_I, the
shear impedance Z and the joint's additional compliance 1/K

    (Z / 2K) s' = sigma_I - s while |s| < tau or |s| is about to fall,   s' = 0 while it slips;
    sigma_T = s,   sigma_R = s - sigma_I,   slip rate 2 (sigma_I - s) / Z

and a joint as stiff as the others is rigid before it slips: s = sigma_I, clipped at +-tau (Miller,
Bull. Seism. Soc. Am. 68, 1978, for the harmonic wave). `slip_phases` integrates this, also for
joints with slip weakening or dilation; `rate_state_joint` does for rate-dependent friction.

Valid for blocks that do not rotate, a load across the axis, absorbing ends, one joint with cohesion
or with friction under the prestress, and all else elastic and undamped.
"""

from math import inf, isfinite
from typing import Any

import numpy as np
import xarray as xr

from jointwave.cases.material.calibrate import Properties, calibrate
from jointwave.cases.sampling import sample_times
from jointwave.cases.schema.law_parts import PARTS, UNLIMITED
from jointwave.cases.schema.scene import Scene
from jointwave.compare.exact.bar.images import entering
from jointwave.compare.exact.conditions import LAYERS, holds
from jointwave.compare.exact.joint import rate_state_joint
from jointwave.compare.exact.joint.one_joint import around
from jointwave.compare.exact.joint.slip_phases import TOLERANCES, Passed, SlipJoint
from jointwave.compare.exact.joint.trajectory import too_stiff
from jointwave.compare.exact.linear import bound
from jointwave.compare.solvers.record import Answer, Kind, Rock, Solver, thin
from jointwave.results.dataset import dataset

PATH_DEPENDENT = ("weakening", "dilation", "rate and state")
RATE_PARAMETERS = next(part.without for part in PARTS if part.name == PATH_DEPENDENT[-1])
HELD = ("spatial motion", "prestress", "fixed start", *PATH_DEPENDENT, *LAYERS)
ROUND_OFF = 1e-11  # tolerance of roots, over the largest waveform


def applies(scene: Scene) -> Answer:
    """Return whether a plane shear wave meets exactly one joint that can slip."""
    p, load, ends = calibrate(scene), scene.load, {scene.ends.start, scene.ends.end}
    if not load.is_across or load.direction[1] or load.arm or scene.motion.rotation != "none":
        return Answer("there is no plane shear wave: needs a load across and no rotation")
    slips, compliance, rated, snaps = _slips(p), p.excess_shear_compliance, p.direct_effect, False
    coheres = rated is not None and p.cohesion is not None and p.cohesion[rated > 0].any()
    if p.weakening_distance is not None and slips.any():
        joint = the_joint(scene, p)
        snaps = joint.fall * joint.compliance >= 1
    return holds(
        scene,
        HELD,
        (not ends <= {"quiet", "matched"}, "an end reflects"),
        (np.count_nonzero(slips) != 1, "not exactly one joint can slip"),
        (bool(coheres), "the rate-and-state joint has cohesion"),
        (
            rated is not None and calibrate(scene).prestress <= 0,
            "the rate-and-state joint has no normal stress",
        ),
        (bool(compliance[~slips].any()), "a joint that cannot slip differs in stiffness"),
        (bool((compliance < 0).any()), "the joint is stiffer than the others"),
        too_stiff(
            float(compliance[slips].max(initial=0.0)), p.shear_impedance, scene.time.duration
        ),
        (snaps, "friction falls with slip faster than the joint unloads"),
        (
            p.dilation is not None and bool(compliance.any() or p.excess_compliance.any()),
            "the joint that dilates is softer than the others",
        ),
    )


def solve(scene: Scene) -> xr.Dataset:
    """Return shear, velocity and displacement on both sides of the slipping joint."""
    times = sample_times(scene)
    found, twin = (_waveforms(scene, which) for which in (0, 1))
    errors = {
        name: bound(x, twin[name]) + ROUND_OFF * np.abs(x).max(initial=0.0)
        for name, x in found.items()
    }
    stress = np.full((len(scene.record.stress), len(times)), calibrate(scene).prestress)
    stress = stress + found.pop("stress", 0.0)
    waves = {name: x.swapaxes(1, 2) for name, x in found.items()}
    waves |= {"stress": stress, "rotation": np.zeros_like(waves["velocity"])}
    return dataset(scene, SOLVER.name, times, waves, errors=errors)


def _waveforms(scene: Scene, which: int) -> dict[str, Any]:
    """Return waveforms [receiver, axis, n], for a dilating or weakening joint also stress
    [receiver, n]; which : 1 for the twin with larger tolerances."""
    p, load, times, record = calibrate(scene), entering(scene), sample_times(scene), scene.record
    joint, Z, axis = the_joint(scene, p), p.shear_impedance, np.array(scene.load.direction)[:, None]
    passed: rate_state_joint.RateStateWave | Passed
    if p.direct_effect is not None:
        own = (float(getattr(p, name)[_slips(p)][0]) for name in ("friction", *RATE_PARAMETERS))
        rated = rate_state_joint.RateJoint(calibrate(scene).prestress, *own)
        rated = rated._replace(compliance=joint.compliance)
        rest, tolerance = joint.y / p.shear_speed, rate_state_joint.TOLERANCES[which]
        passed = rate_state_joint.RateStateWave(rated, Z, load, times[-1], tolerance, rest)
    else:
        passed = Passed(joint, Z, load, times[-1], TOLERANCES[which], p.impedance)
    sheared, ((there, _), (back, _)) = (
        around(joint.y, p.shear_speed, passed, load, times, places)
        for places in (record.velocity, record.stress)
    )
    moved = (sheared[0] - sheared[1])[:, :, None] / Z * axis
    found = {"shear": (there + back)[:, None] * axis[[0, 2]]}
    if isinstance(passed, Passed) and (joint.dilation or isfinite(joint.distance)):
        # P waves along the axis, which a dilating joint radiates to both sides.
        off, of_stress = (np.array(y)[:, None] - joint.y for y in (record.velocity, record.stress))
        at = times - joint.y / p.shear_speed
        sent = np.array(passed.pressure(at - np.abs(off) / p.bar_speed))
        moved[:, :, 1] += np.sign(off) / p.impedance * sent
        found["stress"] = passed.pressure(at - np.abs(of_stress) / p.bar_speed)[0]
    return found | dict(zip(("velocity", "displacement"), moved, strict=True))


def the_joint(scene: Scene, p: Properties) -> SlipJoint:
    """Return the only joint that can slip, with its Mohr-Coulomb strength under the prestress."""
    j, normal = int(np.flatnonzero(_slips(p))[0]), calibrate(scene).prestress

    def own(every: np.ndarray | None, without: float) -> float:
        return without if every is None else float(every[j])

    cohesion, friction = own(p.cohesion, 0.0), own(p.friction, 0.0)
    strength = max(cohesion + friction * normal, 0.0)
    lost = max(cohesion - own(p.residual_cohesion, cohesion), 0.0)
    found = SlipJoint(float(p.joint_y[j]), float(p.excess_shear_compliance[j]), strength)
    found = found._replace(friction=friction, dynamic_friction=friction, lost=lost)
    if normal <= 0:
        return found
    left = own(p.dynamic_friction, friction)
    return found._replace(
        dynamic=cohesion + left * normal,
        dynamic_friction=left,
        distance=own(p.weakening_distance, inf),
        dilation=own(p.dilation, 0.0),
        dilation_distance=own(p.dilation_distance, inf),
    )


def _slips(p: Properties) -> np.ndarray:
    if p.cohesion is not None:
        return p.cohesion < UNLIMITED
    return np.full(len(p.stiffness), p.friction is not None)


SOLVER = Solver(
    name="slip-joint",
    rock=Rock.HOMOGENISED,
    discretised=False,
    label="sliding joint, exact",
    line=thin("#a83200", 8, (9, 18)),
    applies=applies,
    run=solve,
    distances={
        Kind.MODELLING: {
            "dem": "discrete blocks around the slipping joint",
            "continuum-equivalent": "other joints smeared over the bar",
        }
    },
)
