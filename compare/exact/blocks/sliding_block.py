"""A rigid block that slides on a slope under its weight with Coulomb friction.

The second of two blocks is fixed, and gravity g presses the first onto it, at the slope angle beta
from the axis. The joint carries N = m g cos beta and in shear at most N tan phi, so that

    v = max(0, g (sin beta - cos beta tan phi)) t   down the slope;

the shear force is m g sin beta if that is less. The initial settling of the blocks on springs and
dashpots is neglected.

Valid for two blocks, a free start, a fixed end, no load, gravity that acts suddenly and compresses
the joint, friction without cohesion, and blocks that do not topple.
"""

from math import hypot

import numpy as np
import xarray as xr

from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.material.contact_points import lever
from jointwave.cases.sampling import sample_times
from jointwave.cases.schema.scene import Scene
from jointwave.compare.exact.blocks.row_of_blocks import reads
from jointwave.compare.exact.conditions import DAMPED, LAYERS, holds
from jointwave.compare.solvers.record import Answer, Form, Kind, Rock, Solver, thin
from jointwave.results.dataset import dataset

HELD = ("spatial motion", "gravity", "no tension", "fixed start", *DAMPED, *LAYERS)


def applies(scene: Scene) -> Answer:
    """Return whether one rigid block slides or rests on another."""
    p, gravity = calibrate(scene), scene.gravity
    if scene.pillar.block_count != 2:
        return Answer("the pillar does not have two blocks")
    if gravity is None or gravity.static or gravity.direction[1] <= 0:
        return Answer("no sudden gravity compresses the joint")
    stands = (scene.ends.start, scene.ends.end) == ("free", "fixed")
    rubs = p.friction is not None and p.cohesion is None
    answer = holds(
        scene,
        HELD,
        (bool(scene.load.amplitude), "a load acts"),
        (not stands, "the block is not free, or its base is not fixed"),
        (not rubs, "the joint does not slip by friction only"),
    )
    if answer and p.friction is not None and _topples(scene, float(p.friction[0])):
        return Answer("the block topples")
    return answer


def _topples(scene: Scene, friction: float) -> bool:
    """Return whether the joint's resultant lies outside the square of its contact points."""
    if scene.motion.rotation == "none":
        return False
    reach = lever(scene.joints.point_rule, scene.joints.contact_points) * scene.pillar.side / 2
    across, along = _gravity(scene)
    share = min(1.0, friction * along / hypot(*across)) if across.any() else 0.0
    off = share * np.abs(across) / along * scene.pillar.block / 2
    return bool((off > reach).any())


def solve(scene: Scene) -> xr.Dataset:
    """Return stress, shear, velocity and displacement of the block and its base."""
    p, times, (sections, points) = calibrate(scene), sample_times(scene), reads(scene)
    assert p.friction is not None
    across, along = _gravity(scene)
    total = hypot(*across)
    held = min(total, float(p.friction[0]) * along)
    down = across / total if total else across
    weights = p.block_mass * np.array([along * np.arange(3), [0.0, held, held + total]])
    still = np.ones_like(times)
    stress, shear = (np.outer(sections @ weight, still) for weight in weights)
    falls = (total - held) * np.outer(points[:, 0], [down[0], 0.0, down[1]])[:, None]
    velocity, displacement = (falls * t[:, None] for t in (times, times**2 / 2))
    waves = {"stress": stress, "shear": shear[..., None] * down, "velocity": velocity}
    waves |= {"displacement": displacement, "rotation": np.zeros_like(velocity)}
    return dataset(scene, SOLVER.name, times, waves)


def _gravity(scene: Scene) -> tuple[np.ndarray, float]:
    """Return gravity across the axis, [x, z], and along it, m/s2."""
    assert scene.gravity is not None
    g = scene.gravity.acceleration * np.array(scene.gravity.direction)
    return g[[0, 2]], float(g[1])


SOLVER = Solver(
    name="sliding-block",
    rock=Rock.ONE_BODY,
    form=Form.CLOSED,
    dimension=3,
    discretised=False,
    label="sliding block, exact",
    line=thin("#a83200", 8, (9, 18)),
    applies=applies,
    run=solve,
    distances={Kind.MODELLING: {"dem": "blocks settle on springs first"}},
)
