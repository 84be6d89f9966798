"""Waveforms of a rock mass at points and on joints.

The mean stress of a block follows from the forces on it (Love 1927; Weber 1966): with arms x from
the centroid and forces F, S_ij = sum of x_i F_j, less the inertia of the rotation that the moment
S_ij - S_ji accelerates. Along the principal axes of the second moments m this is

    V sigma_ij = (m_j S_ij + m_i S_ji) / (m_i + m_j),

tension positive. At rest, and for squares and cubes, it is the symmetric part of S.

Samples of contacts have the rows, in the contact's frame: force on block j [d], first moments of
the traction about the face's centre [d - 1 axes in the face, d components], opening and slips [d].
Blocks without rotations have no first moments.
"""

from typing import Any

import numpy as np
import xarray as xr

from jointwave.cases.geometry.measure import upwards
from jointwave.dem.kernel.model import Samples, State
from jointwave.dem.readings.receivers import Receivers, everywhere
from jointwave.dem.readings.samples import acting
from jointwave.dem.system import BlockSystem
from jointwave.results.dataset import dataset
from jointwave.results.stress import stress_components


class PointsAndJoints(Receivers):
    """Receivers of a rock mass."""

    def of_all(self, blocks: Any) -> "PointsAndJoints":
        """Return receivers of all blocks and contacts."""
        return PointsAndJoints(*everywhere(blocks.cut, blocks.contacts))

    def shown(
        self, system: BlockSystem, samples: Samples, sample: int
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return block stresses in a snapshot [N, components], Pa, and slips of contacts, m."""
        stress = mean_stress(self, samples.contact, moments(self, system, samples, sample))
        return stress[:, 0], jumps(self, samples.contact)[:, 0, 1]

    def dataset(
        self, system: BlockSystem, state: State, samples: Samples, **attributes: Any
    ) -> xr.Dataset:
        """Return the result of the samples so far."""
        outside, contact = moments(self, system, samples), samples.contact
        return dataset(
            system.blocks.scene,
            "dem",
            system.time.times[: contact.shape[-1]],
            quantities(self, samples.displacement, samples.velocity, contact, outside),
            samples.energy,
            scheme="leapfrog",
            left_over=system.blocks.left_over,
            **attributes,
        )


def moments(
    receivers: Receivers, system: BlockSystem, samples: Samples, first: int = 0
) -> np.ndarray:
    """Return sums of arm times force of sides and loads on recorded blocks [r, d, d, n], N m."""
    dim, places = system.blocks.dim, receivers.places
    found = acting(system, places, samples, first)[:, dim:]
    return found.reshape(len(places), dim, dim, found.shape[-1])


def quantities(
    receivers: Receivers,
    displacement: np.ndarray,
    velocity: np.ndarray,
    contact: np.ndarray,
    outside: np.ndarray | None = None,
) -> dict[str, np.ndarray]:
    """Return waveforms by the names of `results.dataset`.

    displacement, velocity : of recorded blocks [r, F, n]. contact : samples of the watched contacts
    [w, rows, n]. outside : as in `mean_stress`.

    Displacement, gap and slip are relative to the first sample; gap and slip are those of the joint
    alone, without the deformation of the rock in its contact.
    """
    found: dict[str, np.ndarray] = {}
    if receivers.weights.shape[0]:
        found["velocity"] = at_points(receivers, velocity)
        found["displacement"] = at_points(receivers, displacement - displacement[..., :1])
        stress = mean_stress(receivers, contact, outside)
        mean = receivers.weights @ stress.reshape(len(stress), -1)
        found["stress"] = mean.reshape(-1, *stress.shape[1:])
    if receivers.joints.shape[0]:
        turned = upwards(receivers.faces.frame)
        traction, moved = (
            (receivers.joints @ (one @ turned).reshape(len(one), -1)).reshape(-1, *one.shape[1:])
            for one in (tractions(receivers, contact), jumps(receivers, contact))
        )
        moved -= moved[:, :1]
        found |= {"traction": traction, "gap": moved[..., 0]}
        if moved.shape[-1] > 1:
            found["slip"] = moved[..., 1] if moved.shape[-1] == 2 else moved[..., 1:]
    return found


def at_points(receivers: Receivers, motion: np.ndarray) -> np.ndarray:
    """Return vectors at points [points, n, d] from the motion of recorded blocks [r, F, n]."""
    moved = receivers.motion @ motion.reshape(-1, motion.shape[-1])
    dim = receivers.faces.frame.shape[1]
    return moved.reshape(-1, dim, motion.shape[-1]).swapaxes(1, 2)


def mean_stress(
    receivers: Receivers, contact: np.ndarray, outside: np.ndarray | None = None
) -> np.ndarray:
    """Return the mean stress of recorded blocks [r, n, components], Pa, compression positive.

    contact : samples of watched contacts [w, rows, n]. outside : `moments` [r, d, d, n], N m.
    """
    faces, (row, place, side) = receivers.faces, receivers.touching.T
    dim, count = faces.frame.shape[1], contact.shape[-1]
    force = np.einsum("cak,can->ckn", faces.frame, contact[:, :dim])
    own = faces.arm[row, side][:, :, None, None] * force[row, None]
    if contact.shape[1] > 2 * dim:
        moment = contact[:, dim:-dim].reshape(len(contact), dim - 1, dim, count)
        own += np.einsum("cbi,cak,cban->cikn", faces.frame[:, 1:], faces.frame, moment)[row]
    sums = np.zeros((len(receivers.places), dim, dim, count)) if outside is None else outside
    np.add.at(sums, place, np.where(side, 1.0, -1.0)[:, None, None, None] * own)
    moments, axes = np.linalg.eigh(receivers.second)
    share = moments[:, None] / (moments[:, :, None] + moments[:, None])
    part = share[..., None] * np.einsum("rai,rabn,rbj->rijn", axes, sums, axes)
    mean = np.einsum("rai,rijn,rbj->rabn", axes, part + part.swapaxes(1, 2), axes)
    mean /= -receivers.volume[:, None, None, None]
    return np.stack([mean[:, i, j] for i, j in stress_components(dim).values()], axis=-1)


def tractions(receivers: Receivers, contact: np.ndarray) -> np.ndarray:
    """Return the mean traction of the watched contacts [w, n, d], normal first, Pa."""
    faces = receivers.faces
    force = contact[:, : faces.frame.shape[1]]
    return force.swapaxes(1, 2) / faces.area[:, None, None]


def jumps(receivers: Receivers, contact: np.ndarray) -> np.ndarray:
    """Return the opening and slips of the watched contacts' joints [w, n, d], m, without the
    deformation of the rock in the contact."""
    faces = receivers.faces
    dim = faces.frame.shape[1]
    excess = faces.excess[:, np.minimum(np.arange(dim), 1)]
    moved = contact[:, -dim:].swapaxes(1, 2)
    return moved + excess[:, None] * tractions(receivers, contact)
