"""Rigid blocks and the constants of their steps."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from jointwave.cases.geometry.blocks import Blocks as Cut
from jointwave.cases.scene_type import AnyScene
from jointwave.dem.contacts.chunks import Chunks, chunks_of
from jointwave.dem.contacts.faces import Contacts, extents
from jointwave.dem.contacts.law import Columns, points_on
from jointwave.dem.contacts.stability import critical_time_step
from jointwave.dem.kernel.composition import stability_limit
from jointwave.dem.kernel.model import Blocks, KernelFlags
from jointwave.dem.sides.boundaries import freedoms
from jointwave.dem.sides.surroundings import Surroundings
from jointwave.joints.law import Law, parts_of
from jointwave.joints.normal import gap_under

#: Rotations of a block, by dimension.
ROTATIONS = {1: 0, 2: 1, 3: 3}


@dataclass(frozen=True, kw_only=True)
class RigidBlocks(ABC):
    """Rigid blocks, their contacts, loads and boundaries, before time discretisation.

    cut : geometry of the blocks, per metre of thickness in the plane. sides : names of the
    boundary's sides, in order. masses : matrices of mass, kg, and inertia, kg m2, of each block
    [N, F, F]. gravity : [d], m/s2. prestress : tensor [d, d], Pa; None without. pressed : force
    scale of the prestress, N. static_steps : most steps of dynamic relaxation. finite : whether
    blocks rotate by any angle. composed : whether steps are those of `composition`. in_row :
    whether contacts join consecutive blocks. placed : displacement [N, F] under the weight with
    elastic joints; None where it is not known in advance.
    """

    scene: Any
    cut: Cut
    sides: tuple[str, ...]
    contacts: Contacts
    columns: Columns
    masses: np.ndarray
    gravity: np.ndarray
    prestress: np.ndarray | None
    pressed: float
    around: Surroundings
    static_steps: int
    finite: bool = False
    composed: bool = False
    in_row: bool = False
    placed: np.ndarray | None = None

    #: Corners of a block in snapshots, by dimension, and the scene key that sets the block count.
    corners: ClassVar[dict[int, int]]
    counted_by: ClassVar[str]

    @property
    @abstractmethod
    def receivers(self) -> Any:
        """Its receivers; raises SceneError for a point outside the rock."""

    @property
    @abstractmethod
    def bodies(self) -> Any:
        """Bodies of its blocks for snapshots."""

    @property
    def count(self) -> int:
        """Number of blocks."""
        return len(self.masses)

    @property
    def dim(self) -> int:
        """Number of dimensions."""
        return self.cut.body.dim

    @property
    def centroid(self) -> np.ndarray:
        """Centroid of each block [N, d], m."""
        return self.cut.centroid

    @property
    def size(self) -> np.ndarray:
        """Size of each block [N], m; in a row its thickness."""
        if self.in_row:
            return self.cut.volume / self.contacts.area[:1]
        return self.cut.volume ** (1 / self.dim)

    @cached_property
    def onto(self) -> np.ndarray:
        """Matrix [F, d + d^2] of `boundaries.freedoms`."""
        return freedoms(self.dim, self.masses.shape[1] - self.dim)

    @cached_property
    def inertia(self) -> np.ndarray:
        """Mass and moments of inertia of each block [N, F]."""
        return np.ascontiguousarray(np.diagonal(self.masses, axis1=1, axis2=2))

    @cached_property
    def critical(self) -> float:
        """Critical time step of a row, for other blocks a lower bound, s."""
        own = self.contacts, self.columns, self.masses, self.scene.damping.local or 0.0
        if not self.in_row:
            return critical_time_step(*own)
        limit = stability_limit() / 2 if self.composed else 1.0
        return limit * critical_time_step(*own, self.around.springs)

    @property
    def has_points(self) -> bool:
        """Whether forces are computed at contact points, not for whole faces."""
        return self.columns.fails or self.finite

    @cached_property
    def points(self) -> np.ndarray:
        """Contact points [c, points, d] of `law.points_on`."""
        return points_on(self.contacts, self.columns.rules)


def masses_of(cut: Cut, density: np.ndarray, rotations: int) -> np.ndarray:
    """Return mass and inertia matrices about the centroids [N, F, F] from densities [N], kg/m3."""
    dim, second = cut.body.dim, cut.second_moment
    found = np.zeros((cut.count, *[dim + rotations] * 2))
    found[:, :dim, :dim] = cut.volume[:, None, None] * np.eye(dim)
    polar = np.trace(second, axis1=1, axis2=2)
    if rotations == 1:
        found[:, 2, 2] = polar
    elif rotations:
        found[:, 3:, 3:] = polar[:, None, None] * np.eye(3) - second
    return density[:, None, None] * found


def steady_fields(scene: AnyScene, dim: int) -> tuple[np.ndarray, np.ndarray | None]:
    """Return gravity [d], m/s2, and prestress [d, d], Pa (None without), of a scene."""
    axes = np.array([1]) if dim == 1 else np.arange(dim)
    gravity, stress = np.zeros(dim), None
    if scene.gravity is not None:
        gravity = scene.gravity.acceleration * np.array(scene.gravity.direction)[axes]
    if scene.prestress is not None:
        stress = np.array(scene.prestress.tensor)[np.ix_(axes, axes)]
    return gravity, stress


def form_of(blocks: RigidBlocks) -> KernelFlags:
    """Return the effects of blocks."""
    scene, own, dim, around = blocks.scene, blocks.columns, blocks.dim, blocks.around
    weighed = scene.gravity is not None and (scene.gravity.static or bool(around.borne.any()))
    return KernelFlags(
        dim=dim,
        turns=blocks.masses.shape[1] > dim,
        parts=parts_of(own.law)._replace(planar=dim == 2),
        points=blocks.has_points,
        mass_damping=scene.damping.alpha is not None,
        local_damping=bool(scene.damping.local),
        gravity=scene.gravity is not None,
        held=len(around.rows) > 0 or scene.excavated,
        ledger=scene.record.energy,
        stressed=blocks.prestress is not None,
        shaken=bool(around.bases),
        relaxed=weighed or blocks.prestress is not None,
        in_row=blocks.in_row,
        oblique=coupled(blocks.masses),
        matched=bool(around.springs) or bool(around.borne.any()),
        finite=blocks.finite,
    )


def coupled(masses: np.ndarray) -> bool:
    """Return whether the inertia tensor of some block has products of inertia."""
    diagonal = np.diagonal(masses, axis1=1, axis2=2)
    apart = masses - diagonal[:, :, None] * np.eye(masses.shape[1])
    return bool((np.abs(apart) > 1e-12 * diagonal[:, -1, None, None]).any())


def constants(blocks: RigidBlocks, dt: float, masses: np.ndarray) -> Blocks:
    """Return the constants of blocks with these mass matrices [N, F, F] for steps of dt, s."""
    damping, tensor = blocks.scene.damping, masses[:, blocks.dim :, blocks.dim :]
    drag = 0.5 * dt * (damping.alpha or 0.0)
    return Blocks(
        inertia=np.ascontiguousarray(np.diagonal(masses, axis1=1, axis2=2)),
        dt=dt,
        keep=(1 - drag) / (1 + drag),
        local=damping.local or 0.0,
        gravity=blocks.gravity,
        tensor=np.ascontiguousarray(tensor) if coupled(masses) else None,
    )


def chunks(blocks: RigidBlocks) -> Chunks:
    """Return the contacts in chunks, with their tractions under a prestress."""
    own, met = blocks.columns, blocks.contacts
    upper = ((), ((0, 0),), ((0, 0), (1, 1), (0, 1)))[blocks.dim - 1]
    share, start = own.bending[met.column] * met.area, None
    second = np.array([share * met.spread[:, i, j] for i, j in upper])
    if blocks.prestress is not None:
        start = carried(blocks)
        if blocks.dim == 1:  # there jumps are along the axis, without a frame
            start *= met.frame[:, 0]
    return chunks_of(
        met,
        blocks.count,
        blocks.masses.shape[1],
        law=met.column if parts_of(own.law).varied else None,
        extent=extents(met, blocks.points, blocks.count) if blocks.finite else None,
        start=start,
        points=blocks.points if blocks.has_points else None,
        second=None if blocks.has_points else second.T,
    )


def carried(blocks: RigidBlocks) -> np.ndarray:
    """Return the gap and slips [c, d], m, that give each contact its traction under prestress."""
    met, own = blocks.contacts, blocks.columns
    traction = (met.frame @ blocks.prestress @ met.frame[:, 0, :, None])[..., 0]
    law = Law(*(x[met.column] if np.ndim(x) else x for x in own.law))
    gap, shear = gap_under(law, parts_of(law), traction[:, 0]), own.shear[met.column, None]
    still = np.zeros_like(traction[:, 1:])  # rollers have no shear stiffness
    return np.column_stack([gap, -np.divide(traction[:, 1:], shear, out=still, where=shear > 0)])
