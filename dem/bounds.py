"""Bounds on the motion of rigid blocks: highest energy, motion of contacts, rotation."""

import numpy as np

from jointwave.cases.errors import SceneError
from jointwave.cases.loads import highest_frequency
from jointwave.dem.blocks.rigid import carried
from jointwave.dem.contacts.faces import jumps_of, springs_of
from jointwave.dem.kernel.model import State
from jointwave.dem.sides.shaking import variation
from jointwave.dem.system import BlockSystem
from jointwave.numerics.divergence import speed_that
from jointwave.numerics.small_motion import Moved, farthest, overlapping

MOST_TURN = 0.045  # rad: small rotations then neglect 1 - cos = 1e-3 of a lever


def highest_energy(system: BlockSystem, state: State) -> float:
    """Return a bound on sqrt(m) v of any degree of freedom, sqrt(J), from sources, gravity, moving
    walls and the energy stored at the start."""
    blocks, time, mass = system.blocks, system.time, system.blocks.inertia[:, 0]
    own = system.model.blocks
    duration = time.dt * (time.steps + time.stride)
    shaken = 0.0
    if system.shaking is not None:
        shaken = variation(system.shaking(np.arange(time.steps + time.stride)))
    with np.errstate(over="ignore"):
        return speed_that(
            system.loads.impulse(
                blocks.inertia[system.loads.rows], highest_frequency(blocks.scene)
            ),
            duration * np.linalg.norm(own.gravity) * np.sqrt(mass.sum()),
            np.sqrt(mass.sum()) * shaken,
            stored(system, state),
        )


def motion_of_contacts(system: BlockSystem, state: State) -> np.ndarray:
    """Return gap, slips (m) and relative rotations (rad) of contacts, in their frames [c, F]."""
    met, u = system.blocks.contacts, state.u
    rotations = u.shape[1] - system.blocks.dim
    of_i, of_j = (jumps_of(met.frame, arm, rotations) for arm in met.arm.swapaxes(0, 1))
    i, j = u[met.blocks.T, :, None]
    return (of_j @ j - of_i @ i)[..., 0]


def stored(system: BlockSystem, state: State) -> float:
    """Return the root of twice the elastic energy of all contacts, sqrt(J)."""
    met, own, dim = system.blocks.contacts, system.blocks.columns, system.blocks.dim
    moved, rotations = motion_of_contacts(system, state), state.u.shape[1] - dim
    if system.model.form.stressed:
        moved[:, :dim] += carried(system.blocks)
    normal, shear = own.normal[met.column], own.shear[met.column]
    springs = springs_of(normal, shear, met.area, met.spread, rotations)
    return float(np.sqrt(np.einsum("ca,cab,cb->", moved, springs, moved)))


def moved_apart(system: BlockSystem, state: State) -> Moved | None:
    """Return the contact with the largest motion over the size of its smaller block, or in the
    plane blocks that overlap without a contact; None without contacts and in one dimension.

    In a row it is the contact with the largest slip over the side of its face: opening does not
    change the area of contact.
    """
    blocks, met, dim = system.blocks, system.blocks.contacts, system.blocks.dim
    count = blocks.count
    if dim == 2 and (overlap := overlapping(blocks.cut, state.u[:count])) is not None:
        return overlap
    if dim == 1 or not len(met.blocks):
        return None
    moved = motion_of_contacts(system, state)
    by, place = np.linalg.norm(moved[:, 1:dim], axis=1), met.centre
    if blocks.in_row:
        size = np.where(met.blocks[:, 1] < count, np.sqrt(met.area), np.inf)
        place = blocks.centroid[met.blocks[:, 0], 1:2]
    else:
        reach = np.sqrt(3 * np.trace(met.spread, axis1=1, axis2=2))  # to a rectangle's corners
        ends = reach * np.linalg.norm(moved[:, dim:], axis=1)
        held = system.blocks.columns.shear[met.column] > 0  # rollers let blocks slide
        by = np.hypot(np.abs(moved[:, 0]) + ends, by * held)
        size = np.append(blocks.size, np.full(len(met.walls), np.inf))[met.blocks].min(axis=1)
    return farthest(met.blocks, by, size, place, count)


def refuse_large_rotation(system: BlockSystem, state: State, t: float) -> None:
    """Raise SceneError if blocks of a row have rotated too far for small rotations at t (s); for
    other blocks `moved_apart` covers rotations."""
    scene, form = system.blocks.scene, system.model.form
    if not system.blocks.in_row or not form.turns or form.finite:
        return
    turn = np.abs(state.u[: system.blocks.count, form.dim :])
    if turn.max() > MOST_TURN:
        block = int(turn.max(axis=1).argmax()) + 1
        raise SceneError(
            scene.where,
            "motion.rotation",
            scene.motion.rotation,
            f"block {block} has turned by {turn.max():.3g} rad at t = {t:.4g} s, beyond the "
            f"{MOST_TURN:g} rad of small rotations: set motion.rotation = 'finite'",
        )
