"""Waveforms of a run of rigid blocks in the plane, in the form of results.

The mean stress of a block follows from the forces on it (Love 1927; Weber 1966): with arms x from
the centroid and forces F,

    A sigma_ij = sum of x_i F_j,

its symmetric part, tension positive. The inertia of a block's rotation adds rho (I_xx - I_yy) / 2
times the angular acceleration to the shear stress; it is zero for squares and left out.
"""

from __future__ import annotations

import numpy as np

from jointwave.dem.blocks.leapfrog import PlaneSamples
from jointwave.dem.blocks.links import Links
from jointwave.dem.blocks.receivers import BlockReceivers
from jointwave.dem.blocks.system import PlaneSystem
from jointwave.dem.blocks.tile import ALONG, BEND, FORCE_X, FORCE_Y, GAP, SLIP

#: xx, yy and xy of a tensor.
COMPONENTS = ((0, 0), (1, 1), (0, 1))


def quantities(
    system: PlaneSystem, receivers: BlockReceivers, samples: PlaneSamples, count: int
) -> dict[str, np.ndarray]:
    """Return the first `count` samples of a run by name, as `results.plane.plane_dataset` takes
    them. Displacement, gap and slip count from the first sample; gap and slip are those of the
    joint itself, without the strain of the rock that its contact stands for."""
    found: dict[str, np.ndarray] = {}
    record, joints = system.blocks.scene.record, receivers.joints
    moved, velocity, contact = (
        values[..., :count] for values in (samples.displacement, samples.velocity, samples.contact)
    )
    if record.points:
        found["velocity"] = _at_points(receivers, velocity)
        found["displacement"] = _at_points(receivers, moved - moved[..., :1])
        stress = mean_stress(system, receivers, velocity, contact)
        found["stress"] = np.einsum("pr,rnk->pnk", receivers.weights, stress)
    if record.joints:
        traction = tractions(system.blocks.links, receivers, contact)
        found["traction"] = np.einsum("pw,wnk->pnk", joints, traction)
        for k, name in enumerate(("gap", "slip")):
            moved = across_joint(system, receivers, contact, traction, k)
            found[name] = joints @ (moved - moved[:, :1])
    return found


def _at_points(receivers: BlockReceivers, motion: np.ndarray) -> np.ndarray:
    """Return vectors at points [points, n, 2] of the motion of places [r, 3, n]."""
    linear = np.einsum("pr,rkn->pnk", receivers.weights, motion[:, :2])
    return linear + np.einsum("prk,rn->pnk", receivers.turns, motion[:, 2])


def mean_stress(
    system: PlaneSystem,
    receivers: BlockReceivers,
    velocity: np.ndarray,
    contact: np.ndarray,
    first: int = 0,
) -> np.ndarray:
    """Return the mean stress of the places [r, n, (xx, yy, xy)], Pa, compression positive.

    velocity : of the places [r, 3, n]. contact : samples of the watched contacts [w, rows, n].
    first : number of the first sample.
    """
    blocks, places = system.blocks, receivers.places
    watched, place, side = receivers.touching.T
    sums = np.zeros((len(places), 2, 2, contact.shape[-1]))
    own = _moments(blocks.links, receivers.watched[watched], side, contact[watched])
    np.add.at(sums, place, np.where(side, 1.0, -1.0)[:, None, None, None] * own)
    rows = system.sources.rows
    held = np.flatnonzero(np.isin(places, rows))
    if len(held):
        row = np.searchsorted(rows, places[held])
        steps = system.time.stride * (first + np.arange(contact.shape[-1]))
        acting = np.moveaxis(system.sources.sums(steps, row)[..., 2:], 0, -1)
        acting -= np.einsum("hkq,hqn->hkn", system.resistance[row, 2:], velocity[held])
        sums[held] += acting.reshape(len(held), 2, 2, -1)
    mean = -(sums + sums.swapaxes(1, 2)) / (2 * blocks.partition.area[places])[:, None, None, None]
    return np.stack([mean[:, i, j] for i, j in COMPONENTS], axis=-1)


def _moments(links: Links, c: np.ndarray, side: np.ndarray, samples: np.ndarray) -> np.ndarray:
    """Return the sums of arm times force of contacts on their blocks j, about the centroid of their
    block of a side [c, 2, 2, n], N m."""
    normal = links.normal[c]
    along = np.stack([-normal[:, 1], normal[:, 0]], axis=1)
    centroid = np.where(side[:, None], links.beside_j[c], links.beside_i[c])
    arm = (links.start[c] + links.end[c]) / 2 - centroid
    force = samples[:, [FORCE_X, FORCE_Y]]
    spread = np.einsum("ck,cn->ckn", normal, -samples[:, BEND])
    spread += np.einsum("ck,cn->ckn", along, samples[:, ALONG])
    return arm[:, :, None, None] * force[:, None] + along[:, :, None, None] * spread[:, None]


def across_joint(
    system: PlaneSystem,
    receivers: BlockReceivers,
    contact: np.ndarray,
    traction: np.ndarray,
    k: int,
) -> np.ndarray:
    """Return the opening (k = 0) or the slip (1) of the joints of the watched contacts [w, n], m,
    without the strain of the rock that a contact stands for; their traction as by `tractions`."""
    column, excess = system.blocks.links.column, system.blocks.joints.excess[k]
    softness = np.append(excess, 0.0)[np.minimum(column[receivers.watched], len(excess))]
    return contact[:, (GAP, SLIP)[k]] + softness[:, None] * traction[..., k]


def tractions(links: Links, receivers: BlockReceivers, contact: np.ndarray) -> np.ndarray:
    """Return the mean traction of the watched contacts [w, n, 2], normal and along, Pa."""
    normal = links.normal[receivers.watched]
    along = np.stack([-normal[:, 1], normal[:, 0]], axis=1)
    edge = links.end[receivers.watched] - links.start[receivers.watched]
    force = contact[:, [FORCE_X, FORCE_Y]] / np.hypot(*edge.T)[:, None, None]
    return np.stack([np.einsum("wk,wkn->wn", x, force) for x in (normal, along)], axis=-1)
