"""The time constant of every joint's dashpot, from damping ratios or Rayleigh's beta."""

from math import sqrt

import numpy as np

from jointwave.cases.schema.scene import Scene

Constants = tuple[float | None, np.ndarray | None]


def dashpots(scene: Scene, soft: np.ndarray, regular: float, stiffness: np.ndarray) -> Constants:
    """Return the time constants eta = viscosity / stiffness (s) of the rock with its ordinary
    joints, and of each joint [N - 1]; None without dashpots there.

    A damping ratio zeta gives c_n = 2 zeta sqrt(m k_n), hence eta = 2 zeta sqrt(m / k_n), with m
    the block's mass; Rayleigh's beta is the eta of all.

    Parameters
    ----------
    soft : int array, the joints of the soft layers. regular : K'_n of an ordinary joint, Pa/m.
    stiffness : float array [N - 1], K'_n, Pa/m.
    """
    if scene.damping.rayleigh is not None:
        beta = scene.damping.rayleigh.coefficients[1]
        return (beta, np.full(len(stiffness), beta)) if beta else (None, None)
    areal_mass = scene.rock.density * scene.pillar.length / scene.pillar.block_count
    ratios = [scene.joints.damping_ratio, *(layer.damping_ratio for layer in scene.layers)]
    if all(ratio is None for ratio in ratios):
        return None, None

    def eta(ratio: float | None, k: float) -> float:
        return 2 * (ratio or 0.0) * sqrt(areal_mass / k)

    etas = np.full(len(stiffness), eta(ratios[0], regular))
    for j, ratio in zip(soft, ratios[1:], strict=True):
        etas[j] = eta(ratio, stiffness[j])
    return None if ratios[0] is None else eta(ratios[0], regular), etas
