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
    """Rigid blocks, their contacts and what acts on them, before time discretisation.

    cut : the blocks, per metre of thickness in the plane; of a pillar always whole. sides : names
    of the boundary's sides, in order. masses : matrices of mass, kg, and of inertia, kg m2, of each
    block [N, F, F]. gravity : [d], m/s2. prestress : tensor [d, d], Pa; None without. pressed : the
    largest force that this stands for, N. static_steps : the most of dynamic relaxation. finite :
    whether blocks turn by any angle. composed : whether steps are those of `composition`.
    in_row : whether contacts join them one after the other. placed : their displacement [N, F]
    under the weight if all joints were elastic; None where that is not known beforehand.
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

    #: Corners of a block in snapshots, by dimension, and the key that decides how many there are.
    corners: ClassVar[dict[int, int]]
    counted_by: ClassVar[str]

    @property
    @abstractmethod
    def receivers(self) -> Any:
        """What is recorded; raises SceneError for a point outside the rock."""

    @property
    @abstractmethod
    def bodies(self) -> Any:
        """Its blocks as snapshots show them."""

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
        """Of each block [N, d], m."""
        return self.cut.centroid

    @property
    def size(self) -> np.ndarray:
        """Of each block [N], m; in a row its thickness."""
        if self.in_row:
            return self.cut.volume / self.contacts.area[:1]
        return self.cut.volume ** (1 / self.dim)

    @cached_property
    def onto(self) -> np.ndarray:
        """`boundaries.freedoms`."""
        return freedoms(self.dim, self.masses.shape[1] - self.dim)

    @cached_property
    def inertia(self) -> np.ndarray:
        """Mass and moments of inertia of each block [N, F]."""
        return np.ascontiguousarray(np.diagonal(self.masses, axis1=1, axis2=2))

    @cached_property
    def critical(self) -> float:
        """The critical step of a row, or a lower bound of it, s."""
        own = self.contacts, self.columns, self.masses, self.scene.damping.local or 0.0
        if not self.in_row:
            return critical_time_step(*own)
        limit = stability_limit() / 2 if self.composed else 1.0
        return limit * critical_time_step(*own, self.around.springs)

    @property
    def has_points(self) -> bool:
        """Whether forces are found at the points of contacts, not of faces as a whole."""
        return self.columns.fails or self.finite

    @cached_property
    def points(self) -> np.ndarray:
        """`law.points_on`."""
        return points_on(self.contacts, self.columns.rules)


def masses_of(cut: Cut, density: np.ndarray, rotations: int) -> np.ndarray:
    """Return the matrices of mass and inertia about the centroids [N, F, F] of blocks of densities
    [N], kg/m3, with so many rotations."""
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
    """Return the gravity [d], m/s2, and the prestress [d, d], Pa, of a scene; None without."""
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
        matched=bool(around.springs),
        finite=blocks.finite,
    )


def coupled(masses: np.ndarray) -> bool:
    """Return whether rotations of some block about different axes have inertia in common."""
    diagonal = np.diagonal(masses, axis1=1, axis2=2)
    apart = masses - diagonal[:, :, None] * np.eye(masses.shape[1])
    return bool((np.abs(apart) > 1e-12 * diagonal[:, -1, None, None]).any())


def constants(blocks: RigidBlocks, dt: float, masses: np.ndarray) -> Blocks:
    """Return the constants of the blocks for steps of dt, s; masses : matrices of what moves [N, F,
    F]."""
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
    """Return the table of contacts, with their tractions under a prestress."""
    own, met = blocks.columns, blocks.contacts
    upper = ((), ((0, 0),), ((0, 0), (1, 1), (0, 1)))[blocks.dim - 1]
    share, start = own.bending[met.column] * met.area, None
    second = np.array([share * met.spread[:, i, j] for i, j in upper])
    if blocks.prestress is not None:
        start = carried(blocks)
        if blocks.dim == 1:  # where all jumps are along the axis
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
    """Return the gap and the slips that stand for the prestress in each contact [c, d], m."""
    met, own = blocks.contacts, blocks.columns
    traction = (met.frame @ blocks.prestress @ met.frame[:, 0, :, None])[..., 0]
    law = Law(*(x[met.column] if np.ndim(x) else x for x in own.law))
    gap, shear = gap_under(law, parts_of(law), traction[:, 0]), own.shear[met.column, None]
    still = np.zeros_like(traction[:, 1:])  # on rollers
    return np.column_stack([gap, -np.divide(traction[:, 1:], shear, out=still, where=shear > 0)])
