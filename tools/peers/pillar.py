"""The pillar that every code solves: numbers, time steps and load of one scene."""

from math import ceil, sqrt
from typing import NamedTuple

import numpy as np

from jointwave.cases.errors import SceneError
from jointwave.cases.loads import load_history, step_means
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.sampling import sample_times
from jointwave.cases.schema.scene import Scene


class Pillar(NamedTuple):
    """A uniform free pillar in plain numbers, with the time step of all codes.

    blocks, spacing, side, area : number, m, m, m2. mass : of a block, kg.
    density, modulus, poisson : of the rock mass, kg/m3, Pa, 1.
    normal, shear : stiffness of a joint, N/m. joint : number of the recorded one, from 1.
    dt, stride, steps : s, steps per sample, total number of steps.
    load : mean end stress over each step [n], Pa, then zero; see `cases.loads.step_means`.
    """

    blocks: int
    spacing: float
    side: float
    area: float
    mass: float
    density: float
    modulus: float
    poisson: float
    normal: float
    shear: float
    joint: int
    dt: float
    stride: int
    steps: int
    load: np.ndarray

    @property
    def verlet_load(self) -> np.ndarray:
        """The load for codes that start with half a velocity step: step 0 counts twice."""
        return np.append(2 * self.load[0], self.load[1:])

    @property
    def samples(self) -> int:
        """Number of samples, the first at t = 0."""
        return self.steps // self.stride + 1


def pillar(scene: Scene, stride: int) -> Pillar:
    """Return the scene's pillar with `stride` steps per sample.

    Raises SceneError unless the scene records one stress, at a joint.
    """
    p, dt = calibrate(scene), scene.interval / stride
    steps = stride * (len(sample_times(scene)) - 1)
    means = step_means(load_history(scene), dt, np.arange(steps + 1))
    places = scene.record.stress
    joint = round(places[0] / p.spacing) if places else 0
    if len(places) != 1 or abs(joint * p.spacing - places[0]) > 1e-9:
        raise SceneError(scene.where, "record.stress", places, "must be one joint")
    return Pillar(
        blocks=p.block_count,
        spacing=p.spacing,
        side=p.side,
        area=p.area,
        mass=p.block_mass,
        density=p.density,
        modulus=p.modulus,
        poisson=p.poisson,
        normal=p.regular_stiffness * p.area,
        shear=p.regular_shear_stiffness * p.area,
        joint=joint,
        dt=dt,
        stride=stride,
        steps=steps,
        load=means[: min(int(np.flatnonzero(means).max(initial=0)) + 2, steps + 1)],
    )


def stride_for(scene: Scene, size: float, dim: int, fraction: float) -> int:
    """Return the steps per sample for elements of a size, m.

    The step is at most `fraction` of the time in which a wave (in the bar the bar wave, in the
    column the P wave) crosses an element.
    """
    p = calibrate(scene)
    nu = p.poisson if dim == 3 else 0.0
    confined = (1 - nu) / ((1 + nu) * (1 - 2 * nu))
    return ceil(scene.interval * p.bar_speed * sqrt(confined) / (fraction * size))
