"""One joint that slips between two half-spaces of rock, under a plane shear wave.

The joint carries the shear stress s up to its strength tau. With the incident stress sigma_I, the
shear impedance Z and the compliance 1/K that the joint adds to the rock

    (Z / 2K) s' = sigma_I - s while |s| < tau or |s| is about to fall,   s' = 0 while it slips;
    sigma_T = s,   sigma_R = s - sigma_I,   slip rate 2 (sigma_I - s) / Z

and a joint as stiff as the others is rigid before it slips: s = sigma_I, clipped at +-tau (Miller,
Bull. Seism. Soc. Am. 68, 1978, for the harmonic wave). s leaves the linear solution only where it
reaches tau while |sigma_I| > tau, once between two crossings of sigma_I with +-tau, and stays at
tau until the next; between crossings it is integrated exactly. Where slip weakens the
joint, `compare.exact.joint.slip_weakening` integrates it; where its friction depends on the rate
of slip, `compare.exact.joint.rate_state_joint` does.

Valid for blocks that do not rotate, a load across the axis, absorbing ends, one joint with cohesion
or with friction under the prestress, and all else elastic and undamped.
"""

from collections.abc import Iterator
from functools import cache
from math import exp, inf, isfinite
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.polynomial.legendre import leggauss

from jointwave.cases.histories import LoadHistory
from jointwave.cases.loads import load_history
from jointwave.cases.material.calibrate import Properties, calibrate
from jointwave.cases.sampling import sample_times
from jointwave.cases.schema.joint import UNLIMITED
from jointwave.cases.schema.scene import Scene
from jointwave.compare.exact.bar.images import ENTERS
from jointwave.compare.exact.conditions import LAYERS, holds, static_stress
from jointwave.compare.exact.joint import rate_state_joint
from jointwave.compare.exact.joint.one_joint import around
from jointwave.compare.exact.linear import bound
from jointwave.compare.solvers.record import ALONE, Answer, Kind, Rock, Solver, Words, no, thin
from jointwave.results.dataset import dataset

WORN = ("weakening", "dilation", "rate and state")
HELD = ("spatial motion", "prestress", "fixed start", *WORN, *LAYERS)
_gauss = cache(leggauss)
ROUND_OFF = 1e-11  # of the largest waveform: the roots' tolerance
TOLERANCES = 1e-11, 1e-9  # of the integration where slip weakens the joint, and of its twin
FORGOTTEN = 40.0  # time constants after which exp is below round-off


class SlipJoint(NamedTuple):
    """A joint: y (m), its additional compliance 1/K (m/Pa), its strength tau (Pa), and the slip
    path (m) over which it falls to the dynamic one (Pa).

    friction, dynamic_friction : tan(phi) of both. dilation, dilation_distance : initial tan(psi),
    and the slip path (m) over which it falls to 0.
    """

    y: float
    compliance: float
    strength: float
    dynamic: float = 0.0
    distance: float = inf
    friction: float = 0.0
    dynamic_friction: float = 0.0
    dilation: float = 0.0
    dilation_distance: float = inf

    @property
    def fall(self) -> float:
        """Loss of strength per slip path, Pa/m."""
        return (self.strength - self.dynamic) / self.distance

    def left(self, path: Any) -> Any:
        """Return the strength (Pa) after a slip path (m)."""
        return self.strength - self.fall * np.minimum(path, self.distance)

    def friction_at(self, path: Any) -> Any:
        """Return tan(phi) after a slip path (m)."""
        fall = (self.friction - self.dynamic_friction) / self.distance
        return self.friction - fall * np.minimum(path, self.distance)

    def lift(self, path: Any) -> Any:
        """Return the opening of the joint by dilation after a slip path (m), m."""
        way = np.minimum(path, self.dilation_distance)
        return self.dilation * way * (1 - way / self.dilation_distance / 2)

    def lift_rate(self, path: Any) -> Any:
        """Return the derivative of `lift` with respect to the path."""
        return self.dilation * np.maximum(1 - path / self.dilation_distance, 0.0)

    def scaled(self, factor: float) -> "SlipJoint":
        """Return the joint for stresses and slips divided by this factor; both scale alike."""
        names = ("strength", "dynamic", "distance", "dilation_distance")
        return self._replace(**{name: getattr(self, name) / factor for name in names})


def applies(scene: Scene) -> Answer:
    """Return whether a plane shear wave meets exactly one joint that can slip."""
    p, load, ends = calibrate(scene), scene.load, {scene.ends.start, scene.ends.end}
    if not load.is_across or load.direction[1] or load.arm or scene.motion.rotation != "none":
        return no("there is no plane shear wave: needs a load across and no rotation")
    slips, compliance = _slips(p), _excess_compliance(p)
    return holds(
        scene,
        HELD,
        (not ends <= {"quiet", "matched"}, "an end reflects"),
        (np.count_nonzero(slips) != 1, "not exactly one joint can slip"),
        (p.residual_cohesion is not None, "slip weakens the joint"),
        *_against_rate(scene, p),
        (bool(compliance[~slips].any()), "a joint that cannot slip differs in stiffness"),
        (bool((compliance < 0).any()), "the joint is stiffer than the others"),
        (_snaps(scene, p), "friction falls with slip faster than the joint unloads"),
        (
            p.dilation is not None and bool(compliance.any() or p.excess_compliance.any()),
            "the joint that dilates is softer than the others",
        ),
    )


def _against_rate(scene: Scene, p: Properties) -> Iterator[tuple[bool, str]]:
    """Yield conditions that exclude the solution of a joint with rate-dependent friction."""
    if p.direct_effect is not None:
        rated = p.direct_effect > 0
        holds_still = p.cohesion is not None and bool(p.cohesion[rated].any())
        yield holds_still, "the rate-and-state joint has cohesion"
        pressed = scene.prestress is not None and scene.prestress.normal > 0
        yield not pressed, "the rate-and-state joint has no normal stress"


def _snaps(scene: Scene, p: Properties) -> bool:
    if p.weakening_distance is None or not _slips(p).any():
        return False
    joint = the_joint(scene, p)
    return joint.fall * joint.compliance >= 1


def solve(scene: Scene) -> xr.Dataset:
    """Return shear, velocity and displacement on both sides of the joint that slips."""
    p, load, times = calibrate(scene), load_history(scene), sample_times(scene)
    from jointwave.compare.exact.joint import slip_weakening

    joint, enters = the_joint(scene, p), ENTERS[scene.ends.start]
    scaled = joint.scaled(enters)
    is_path_dependent = isfinite(joint.distance) or joint.dilation > 0
    rated = None
    if p.direct_effect is not None:
        j, pressure = int(np.flatnonzero(_slips(p))[0]), static_stress(scene)
        rated = rate_state_joint.rate_joint(p, j, pressure, joint.compliance).scaled(enters)

    def waveforms(parts: int) -> dict[str, Any]:
        weakened, tolerance = None, TOLERANCES[parts - 1]
        if rated is not None:
            rest = joint.y / p.shear_speed
            passed: Any = rate_state_joint.RateStateWave(
                rated, p.shear_impedance, load, times[-1], tolerance, rest
            )
        elif is_path_dependent:
            passed = weakened = slip_weakening.Passed(
                scaled, p.shear_impedance, load, times[-1], tolerance, p.impedance
            )
        else:

            def passed(at: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
                stress, impulse = transmitted(scaled, p.shear_impedance, load, _finer(at, parts))
                return stress[::parts], impulse[::parts]

        def waves(places: list[float]) -> np.ndarray:
            return enters * around(joint.y, p.shear_speed, passed, load, times, places)

        (there, _), (back, _) = waves(scene.record.stress)
        shear = (there + back)[..., None] * load_axis(scene)[[0, 2]]
        there, back = waves(scene.record.velocity)
        velocity, displacement = (there - back)[..., None] / p.shear_impedance * load_axis(scene)
        own = {"shear": shear, "velocity": velocity, "displacement": displacement}
        return own if weakened is None else own | _lifted(scene, p, joint.y, weakened, enters, own)

    found, twin = waveforms(1), waveforms(2)
    errors = {name: _bound(found[name], twin[name]) for name in found}
    stress = np.full((len(scene.record.stress), len(times)), static_stress(scene))
    stress = stress + found.pop("stress", 0.0)
    rotation = np.zeros_like(found["velocity"])
    return dataset(scene, SOLVER.name, times, stress, **found, rotation=rotation, errors=errors)


def _lifted(
    scene: Scene, p: Properties, joint_y: float, weakened: Any, enters: float, waves: dict
) -> dict[str, np.ndarray]:
    """Return stress, velocity and displacement with the pressure waves that the joint radiates
    along the axis on both sides as it dilates; waves : those of the shear wave."""
    times = sample_times(scene)

    def pressure(places: list[float]) -> np.ndarray:
        late = np.abs(np.array(places)[:, None] - joint_y) / p.bar_speed
        return enters * np.array(weakened.pressure(times - joint_y / p.shear_speed - late))

    found = {key: waves[key].copy() for key in ("velocity", "displacement")}
    side = np.sign(np.array(scene.record.velocity) - joint_y)[:, None] / p.impedance
    for key, sent in zip(found, pressure(scene.record.velocity), strict=True):
        found[key][..., 1] += side * sent
    return found | {"stress": pressure(scene.record.stress)[0]}


def _finer(times: np.ndarray, parts: int) -> np.ndarray:
    """Return equally spaced times with each interval divided into `parts`."""
    count = parts * (len(times) - 1) + 1
    return times[0] + (times[1] - times[0]) / parts * np.arange(count)


def _bound(one: np.ndarray, twin: np.ndarray) -> np.ndarray:
    """Return the error bound of waveforms [receiver, n, axis], or [receiver, n], from a twin that
    integrates, and locates the beginning and end of slip, in intervals of half the length."""
    peak = np.abs(one).max(initial=0.0)
    own, other = (np.moveaxis(x, 1, -1) for x in (one, twin))
    return bound(own, other) + ROUND_OFF * peak


def load_axis(scene: Scene) -> np.ndarray:
    """Return the unit vector along which the load acts, float array [3]."""
    return np.array(scene.load.direction)


def the_joint(scene: Scene, p: Properties) -> SlipJoint:
    """Return the only joint that can slip; its strength is Mohr-Coulomb's under the prestress."""
    j, normal = int(np.flatnonzero(_slips(p))[0]), static_stress(scene)
    cohesion = 0.0 if p.cohesion is None else float(p.cohesion[j])
    friction = 0.0 if p.friction is None else float(p.friction[j])
    strength = max(cohesion + friction * normal, 0.0)
    found = SlipJoint(float(p.joint_y[j]), float(_excess_compliance(p)[j]), strength)
    found = found._replace(friction=friction, dynamic_friction=friction)
    if normal <= 0:
        return found
    if p.dilation is not None and p.dilation_distance is not None:
        dilation, distance = float(p.dilation[j]), float(p.dilation_distance[j])
        found = found._replace(dynamic=strength, dilation=dilation, dilation_distance=distance)
    if p.weakening_distance is None or p.dynamic_friction is None:
        return found
    left, distance = float(p.dynamic_friction[j]), float(p.weakening_distance[j])
    dynamic = cohesion + left * normal
    return found._replace(dynamic=dynamic, distance=distance, dynamic_friction=left)


def _slips(p: Properties) -> np.ndarray:
    if p.cohesion is not None:
        return p.cohesion < UNLIMITED
    return np.full(len(p.stiffness), p.friction is not None)


def _excess_compliance(p: Properties) -> np.ndarray:
    regular = p.regular_shear_stiffness
    same = np.isclose(p.shear_stiffness, regular, rtol=1e-9, atol=0)
    return np.where(same, 0.0, 1 / p.shear_stiffness - 1 / regular)


def transmitted(
    joint: SlipJoint, impedance: float, load: LoadHistory, times: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return sigma_T (Pa) and its impulse (Pa s) at the joint for the incident stress `load`.

    `times` increase and begin before the load does; between two of them the load crosses each of
    +-tau at most once.
    """
    tau, relaxation = joint.strength, impedance * joint.compliance / 2
    nodes = _nodes(load, times, tau)
    middle = load.value((nodes[1:] + nodes[:-1]) / 2)
    limits = np.where(np.abs(middle) > tau, np.copysign(tau, middle), np.nan)
    if relaxation == 0:
        growth = np.where(np.isnan(limits), np.diff(load.impulse(nodes)), limits * np.diff(nodes))
        impulse = np.concatenate([[0.0], np.cumsum(growth)])
        return np.clip(load.value(times), -tau, tau), impulse[np.searchsorted(nodes, times)]
    found = [(0.0, 0.0)]
    decays, entered = np.exp(-np.diff(nodes) / relaxation), np.diff(load.impulse(nodes))
    columns = nodes[:-1], nodes[1:], limits, decays, _loaded(load, relaxation, nodes), entered
    for each in zip(*(column.tolist() for column in columns), strict=True):
        found.append(_advance(load, relaxation, *found[-1], *each))
    stress, impulse = np.array(found)[np.searchsorted(nodes, times)].T
    return stress, impulse


def _nodes(load: LoadHistory, times: np.ndarray, tau: float) -> np.ndarray:
    """Return the times, the breaks of the load, and where it crosses +-tau, in order."""
    from scipy.optimize import brentq

    smooth = np.unique([*times, *(t for t in load.breaks if times[0] < t < times[-1])])
    inside = 1e-9 * np.diff(smooth)
    left, right, crossings = smooth[:-1] + inside, smooth[1:] - inside, []
    for level in (-tau, tau):
        crosses = (load.value(left) < level) != (load.value(right) < level)
        for i in np.flatnonzero(crosses):
            excess = lambda t, level=level: float(load.value(t)) - level  # noqa: E731
            crossings.append(brentq(excess, left[i], right[i], xtol=1e-15))
    return np.unique([*smooth, *crossings])


def _advance(
    load, relaxation, stress, impulse, start, end, limit, decay, loaded, entered
) -> tuple[float, float]:
    """Return s and its impulse at `end` from those at `start`.

    limit : of s, Pa, nan while |load| <= tau. decay, loaded, entered : what is left of s, what the
    load adds to it (Pa), and the load's impulse (Pa s) until `end`.
    """
    from scipy.optimize import brentq

    if stress == limit:
        return stress, impulse + stress * (end - start)
    later = stress * decay + loaded
    if not abs(later) > abs(limit):
        return later, impulse + (entered - relaxation * (later - stress))

    def miss(t: float) -> float:
        left = stress * exp((start - t) / relaxation)
        return left + float(_loaded(load, relaxation, np.array([start, t]))[0]) - limit

    slipping = brentq(miss, start, end, xtol=1e-15)
    sticking = float(load.impulse(slipping) - load.impulse(start)) - relaxation * (limit - stress)
    return limit, impulse + sticking + limit * (end - slipping)


def _loaded(load: LoadHistory, relaxation: float, nodes: np.ndarray) -> np.ndarray:
    """Return the solution of T s' = sigma_I - s, T the relaxation time (s), at the end of each span
    between two nodes (s), from 0 at its beginning."""
    widths = np.minimum(np.diff(nodes), FORGOTTEN * relaxation)
    counts = 16 + np.ceil(widths / relaxation).astype(int)
    found = np.empty(len(widths))
    for count in np.unique(counts):
        x, weights = _gauss(int(count))
        own = counts == count
        width, end = widths[own, None], nodes[1:][own, None]
        before = width * (1 - x) / 2
        kernel = weights * width / 2 * np.exp(-before / relaxation) / relaxation
        found[own] = np.sum(kernel * load.value(end - before), axis=1)
    return found


SOLVER = Solver(
    name="slip-joint",
    rock=Rock.HOMOGENISED,
    discretised=False,
    words=Words(ALONE, "sliding joint, exact"),
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
