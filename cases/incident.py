"""Waves that enter a rock mass through its quiet sides, as tractions on these sides.

With the outward normal n, a side crossed by the field (v, sigma) has the traction

    sigma n + rho a (v - v_rock)_n + rho b (v - v_rock)_s

(Lysmer & Kuhlemeyer, J. Eng. Mech. Div. ASCE 95, 1969; Joyner & Chen, BSSA 65, 1975). The part with
v_rock is the dashpot of the side; the rest, `tractions`, is known before the run.
"""

import logging
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np

from jointwave.cases.errors import SceneError
from jointwave.cases.histories import LoadHistory
from jointwave.cases.loads import history_of
from jointwave.cases.material.rock import ElasticRock, elastic_rock
from jointwave.cases.partition.joints import region_at, rocks_of
from jointwave.cases.schema.pulse import Wave
from jointwave.cases.schema.rock_mass import RockMass

log = logging.getLogger("jointwave")
TAKE = "jointwave.simulate takes the field that belongs to the scene"

#: Index of sigma_ij among the components xx; xx, yy, xy; xx, yy, zz, xy, yz, xz.
COMPONENT = {
    1: np.array([[0]]),
    2: np.array([[0, 2], [2, 1]]),
    3: np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2]]),
}
AT_ONCE = 16  # points whose tractions are computed together, to stay in the cache
ALIKE = 1e-9  # difference, in samples, of times that are sampled
BEYOND = 20  # samples on either side of the requested times
WITHIN = 1e-6  # shift from a domain's corner into the rock, over the distance to the centre


class WaveMotion(NamedTuple):
    """Particle velocity [points, d, times], m/s, and stress [points, components, times], Pa,
    tension positive: in the plane xx, yy, xy, in space xx, yy, zz, xy, yz, xz."""

    velocity: np.ndarray
    stress: np.ndarray


class IncidentField(Protocol):
    """Motion of the rock mass without artificial sides; it enters through all quiet sides."""

    def __call__(self, points: np.ndarray, times: np.ndarray) -> WaveMotion:
        """Return the motion at points [m, d] (m) and equally spaced times [n] (s)."""


def in_components(tensor: np.ndarray) -> np.ndarray:
    """Return the components of symmetric tensors [..., d, d], in the order of a `WaveMotion`."""
    _, first = np.unique(COMPONENT[tensor.shape[-1]], return_index=True)
    return tensor.reshape(*tensor.shape[:-2], -1)[..., first]


@dataclass(frozen=True)
class PlaneWave:
    """One plane wave in rock without joints.

    direction, polarisation : unit vectors. speed : m/s. through : point that the pulse reaches at t
    = 0, m. pulse : particle velocity along the polarisation, m/s; its integral is the displacement.
    """

    rock: ElasticRock
    direction: np.ndarray
    polarisation: np.ndarray
    speed: float
    through: np.ndarray
    pulse: LoadHistory

    def lateness(self, points: np.ndarray) -> np.ndarray:
        """Return the arrival time of the pulse at points [m, d], s."""
        return (np.asarray(points) - self.through) @ self.direction / self.speed

    def unit_stress(self) -> np.ndarray:
        """Return the stress at 1 m/s, -C : (n g) / c, in the components of a `WaveMotion`, Pa."""
        n, g, rock = self.direction, self.polarisation, self.rock
        tensor = rock.lame * (n @ g) * np.eye(len(n)) + rock.shear_modulus * (
            np.outer(n, g) + np.outer(g, n)
        )
        return -in_components(tensor) / self.speed

    def motion(self, points: np.ndarray, times: np.ndarray) -> WaveMotion:
        """Return velocity and stress at points and times."""
        f = self.pulse.value(np.asarray(times) - self.lateness(points)[:, None])[:, None]
        return WaveMotion(f * self.polarisation[:, None], f * self.unit_stress()[:, None])


@dataclass(frozen=True)
class PlaneWaves:
    """Superposed plane waves."""

    waves: tuple[PlaneWave, ...]

    def __call__(self, points: np.ndarray, times: np.ndarray) -> WaveMotion:
        zero = np.zeros((len(points), 1, 1))
        found = [one.motion(points, times) for one in self.waves]
        return WaveMotion(
            sum((m.velocity for m in found), start=zero), sum((m.stress for m in found), start=zero)
        )


class FreeField(PlaneWaves):
    """The waves of a scene in its intact rock without joints."""


def free_field(scene: RockMass) -> FreeField:
    """Return the field of all waves of a scene in rock without joints, with a warning where it has
    some. Raises SceneError if waves cross several regions of rock, where they do not stay plane."""
    if scene.waves and scene.regions:
        raise SceneError(scene.where, "waves", len(scene.waves), f"cross several rocks: {TAKE}")
    if scene.waves and scene.joint_sets:
        log.warning(f"{scene.where}: waves: enter all sides as in rock without joints: {TAKE}")
    return FreeField(tuple(plane_wave(scene, one) for one in scene.waves))


def plane_wave(scene: RockMass, wave: Wave) -> PlaneWave:
    """Return a wave of a scene in the rock at the domain's corner that it meets first.

    Particles of an S wave move to the left of its direction, in space along its `polarisation`'s
    part normal to it. Stress on the front, -sigma_nn of P and -sigma_ns of S, is impedance times
    velocity.
    """
    n, corners = np.array(wave.direction), np.array(scene.domain.corners)
    first = corners[np.argmin(corners @ n)]
    inside = first + WITHIN * (corners.mean(axis=0) - first)
    rock = elastic_rock(rocks_of(scene)[region_at(scene.regions, inside[None])[0]])
    is_p = wave.kind == "P"
    speed = float(rock.p_speed if is_p else rock.s_speed)
    polarisation = n if is_p else across(n, wave)
    through = first if wave.through is None else np.array(wave.through)
    over = float(rock.density) * speed if wave.quantity == "stress" else 1.0
    return PlaneWave(rock, n, polarisation, speed, through, history_of(wave, wave.amplitude / over))


def across(n: np.ndarray, wave: Wave) -> np.ndarray:
    """Return the polarisation of an S wave that travels along n, a unit vector."""
    if wave.polarisation is None:
        return np.array([-n[1], n[0]])
    across = np.array(wave.polarisation) - (n @ wave.polarisation) * n
    return across / np.linalg.norm(across)


class FaceTractions(NamedTuple):
    """Tractions of a field at points of sides, without the dashpot term of the rock's velocity.

    times : equally spaced [n], s. values : [n, m, d], Pa.
    """

    times: np.ndarray
    values: np.ndarray

    def at(
        self, times: np.ndarray, of: Callable[[np.ndarray], np.ndarray] = lambda values: values
    ) -> np.ndarray:
        """Return the tractions at times [k], s, by cubic interpolation [k, m, d], Pa.

        of : linear function of the samples [n, m, d] to interpolate instead. Results are the same
        for any batch of times: the influence of omitted samples falls by 2 - sqrt(3) per sample.
        """
        from scipy.interpolate import CubicSpline

        dt = self.times[1] - self.times[0]
        places = (times - self.times[0]) / dt
        there = np.rint(places).astype(int)
        sampled = (np.abs(places - there) < ALIKE) & (there >= 0) & (there < len(self.values))
        if sampled.all():
            return of(self.values[there])  # many times faster
        low = max(int((times[0] - self.times[0]) / dt) - BEYOND, 0)
        high = int((times[-1] - self.times[0]) / dt) + BEYOND + 2
        window = slice(low, max(high, low + 4))
        return CubicSpline(self.times[window], of(self.values[window]))(times)


def tractions(
    field: IncidentField,
    points: np.ndarray,
    normals: np.ndarray,
    impedance: np.ndarray,
    times: np.ndarray,
) -> FaceTractions:
    """Return sigma n + Z v of a field at points [m, d] with outward normals [m, d].

    impedance : Z of the dashpots there, [m, d, d], Pa s/m. times : equally spaced, s.
    """
    velocity, stress = field(points, times)
    normals, Z = np.asarray(normals)[:, :, None], np.asarray(impedance)
    values = np.empty((len(times), *normals.shape[:2]))
    tensor = COMPONENT[normals.shape[1]]
    for k in range(0, len(normals), AT_ONCE):
        some = slice(k, k + AT_ONCE)
        n, v = normals[some], velocity[some]
        pulled = (stress[some][:, tensor] * n[:, None]).sum(axis=2)
        values[:, some] = np.moveaxis(pulled + Z[some] @ v, 2, 0)
    return FaceTractions(np.asarray(times), values)
