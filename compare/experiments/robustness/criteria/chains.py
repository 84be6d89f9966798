"""Chains of any joints and masses by leapfrog in closed form: round-off is all that is left."""

from __future__ import annotations

import numpy as np

from cases.loads import load_history, step_means
from cases.material.calibrate import calibrate
from cases.sampling import interpolation
from cases.schema.scene import Scene
from compare.exact.schemes.leapfrog import modes, of_modes


def displacements(
    scene: Scene, dt: float, times: np.ndarray, weld: float | None = None
) -> np.ndarray:
    """Return the displacements [points, n] (m) of an undamped chain of free ends at sample times.

    dt : the engine's step, s. weld : y of a joint whose blocks are one, m.
    """
    p = calibrate(scene)
    block = np.arange(p.block_count)
    if weld is not None:
        block[round(weld / p.spacing) :] -= 1
    mass = p.block_mass * np.bincount(block).astype(float)
    k = (p.stiffness * p.area)[np.diff(block) > 0]
    root = np.sqrt(k)[:, None] * np.diff(np.eye(len(mass)), axis=0)
    steps = np.rint(times / dt).astype(int)
    force = p.area * step_means(load_history(scene), dt, int(steps[-1]) + 1)
    u = of_modes(modes(mass, root), np.eye(len(mass))[0], force, steps, dt)[block]
    centres = p.spacing * (np.arange(p.block_count) + 0.5)
    left, right, weight = interpolation(centres, scene.record.velocity)
    weight = weight[:, None]
    return (1 - weight) * u[left] + weight * u[right]
