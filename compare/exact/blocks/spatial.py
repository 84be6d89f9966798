"""The row of rigid blocks in space, linear and of small rotation: its matrices.

Block i has the motion q_i = (u_x, u_y, u_z, theta_x, theta_y, theta_z) of its centroid. A face at
the distance h from it along y moves by u + theta x (0, h, 0); at contact j, from the start's face
(j = 0) over the joints to the end's (j = N), the relative motion is the right side's minus the
left side's, and point (x, z) of the contact moves by

    gap = r_y + phi_z x - phi_x z,   slip = (r_x + phi_y z, r_z - phi_y x)

Springs K and K_s per unit area at all points add up to the contact's matrix (Guo & Li 2002,
equations 1, 2); dashpots on a face likewise. Symmetrically placed points decouple stretching,
torsion and the two bendings, and each is a `Plane` of its own.
"""

from dataclasses import dataclass

import numpy as np

from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.material.face import face_points
from jointwave.cases.schema.scene import Scene

#: Degrees of freedom that are coupled by the kinematics.
PLANES = {"none": ((0,), (1,), (2,)), "small": ((1,), (4,), (0, 5), (2, 3))}


@dataclass(frozen=True)
class Row:
    """A row of N blocks between two ends, in all six degrees of freedom; SI units.

    Attributes
    ----------
    spacing : block thickness, m.
    inertia : float array [6], mass (kg) and moments of inertia (kg m2) of a block.
    stiffness, viscosity : float arrays [N + 1, 6, 6] of the contacts, the ends included.
    dashpot : float array [6, 6] of the massless face of a matched end.
    ends : supports of the start and the end.
    mass_damping : alpha of mass-proportional damping, 1/s.
    """

    spacing: float
    inertia: np.ndarray
    stiffness: np.ndarray
    viscosity: np.ndarray
    dashpot: np.ndarray
    ends: tuple[str, str]
    mass_damping: float = 0.0

    @property
    def block_count(self) -> int:
        """Number of blocks N."""
        return len(self.stiffness) - 1


@dataclass(frozen=True)
class Plane:
    """The c coupled degrees of freedom of every block, and the N + 1 contacts between them.

    Coordinates are the motions of the start's face, the N blocks and the end's face, c each.

    Attributes
    ----------
    freedoms : which of the six.
    mass : float array [N c], of the blocks; the faces have none.
    relative : float array [(N + 1) c, (N + 2) c], relative motion of the contacts per coordinate.
    stiffness, viscosity : float arrays [(N + 1) c, (N + 1) c] of the contacts.
    dashpot : float array [c, c] of a matched end's face.
    matched : whether the face of the start and of the end is on that dashpot, else held.
    mass_damping : alpha, 1/s.
    """

    freedoms: tuple[int, ...]
    mass: np.ndarray
    relative: np.ndarray
    stiffness: np.ndarray
    viscosity: np.ndarray
    dashpot: np.ndarray
    matched: tuple[bool, bool]
    mass_damping: float

    @property
    def blocks(self) -> np.ndarray:
        """Indices of the blocks' coordinates, int array [N c]."""
        c = len(self.freedoms)
        return np.arange(c, c + len(self.mass))

    @property
    def faces(self) -> np.ndarray:
        """Indices of the matched faces' coordinates, int array."""
        c, count = len(self.freedoms), self.relative.shape[1]
        sides = (np.arange(c), np.arange(count - c, count))
        chosen = [side for side, free in zip(sides, self.matched, strict=True) if free]
        return np.concatenate([np.zeros(0, dtype=np.int64), *chosen])


def row(scene: Scene, held: bool = False) -> Row:
    """Return the scene's row of blocks, without slip, opening and softening; held : as it stands
    under gravity, with ends that are fixed where they bear it, else free."""
    p, kinds = calibrate(scene), (scene.ends.start, scene.ends.end)
    if held:
        at_start, at_end = (a == "fixed" or b for a, b in zip(kinds, scene.bears, strict=True))
        kinds = "fixed" if at_start else "free", "fixed" if at_end else "free"
    points = face_points(scene.pillar.side, scene.joints.contact_points, scene.joints.point_rule)
    half = face_matrix(points, 2 * p.regular_stiffness, 2 * p.regular_shear_stiffness)
    wall = face_matrix(points, p.wall_stiffness, p.wall_shear_stiffness)
    dashpot = face_matrix(points, p.impedance, p.shear_impedance)
    springs = [
        face_matrix(points, normal, shear)
        for normal, shear in zip(p.stiffness, p.shear_stiffness, strict=True)
    ]
    etas = np.zeros(len(springs)) if p.joint_time_constant is None else p.joint_time_constant
    eta = p.time_constant or 0.0
    start, end = (_end(k, wall if k == "fixed" else half, dashpot, eta) for k in kinds)
    dashpots = [eta * spring for eta, spring in zip(etas, springs, strict=True)]
    across, along = p.inertia_across, p.inertia_along
    return Row(
        spacing=p.spacing,
        inertia=np.array([p.block_mass] * 3 + [across, along, across]),
        stiffness=np.array([start[0], *springs, end[0]]),
        viscosity=np.array([start[1], *dashpots, end[1]]),
        dashpot=dashpot,
        ends=kinds,
        mass_damping=p.mass_damping or 0.0,
    )


def face_matrix(points: tuple, normal: float, shear: float) -> np.ndarray:
    """Return the resistance of a face, [6, 6]: forces and moments at its centre per unit motion.

    points : x, z (m) and area (m2) of the contact points; normal, shear : stiffness (Pa/m) or
    impedance (Pa s/m) per unit area.
    """
    x, z, area = points
    no, one = np.zeros_like(x), np.ones_like(x)
    slip_x = np.stack([one, no, no, no, z, no])
    gap = np.stack([no, one, no, -z, no, x])
    slip_z = np.stack([no, no, one, no, -x, no])
    slip = (area * slip_x) @ slip_x.T + (area * slip_z) @ slip_z.T
    return normal * (area * gap) @ gap.T + shear * slip


def to_face(h: float) -> np.ndarray:
    """Return the matrix [6, 6] from block to face motion; h (m) from the centroid along y."""
    matrix = np.eye(6)
    matrix[0, 5], matrix[2, 3] = -h, h
    return matrix


def plane(row: Row, freedoms: tuple[int, ...]) -> Plane:
    """Return the part of the row that moves in these degrees of freedom."""
    n, c, own = row.block_count, len(freedoms), np.ix_(freedoms, freedoms)
    start, end = (kind == "matched" for kind in row.ends)
    return Plane(
        freedoms=freedoms,
        mass=np.tile(row.inertia[list(freedoms)], n),
        relative=_relative(n, c, *(to_face(h)[own] for h in (-row.spacing / 2, row.spacing / 2))),
        stiffness=_diagonal([k[own] for k in row.stiffness]),
        viscosity=_diagonal([k[own] for k in row.viscosity]),
        dashpot=row.dashpot[own],
        matched=(start, end),
        mass_damping=row.mass_damping,
    )


def _relative(n: int, c: int, left_face: np.ndarray, right_face: np.ndarray) -> np.ndarray:
    """Return the matrix from the coordinates of a plane to the contacts' relative motions."""
    matrix, j = np.zeros((n + 1, c, n + 2, c)), np.arange(n)
    matrix[j, :, j + 1, :] = left_face
    matrix[j + 1, :, j + 1, :] = -right_face
    matrix[0, :, 0, :], matrix[n, :, n + 1, :] = -np.eye(c), np.eye(c)
    return matrix.reshape((n + 1) * c, (n + 2) * c)


def _diagonal(blocks: list[np.ndarray]) -> np.ndarray:
    n, c, j = len(blocks), len(blocks[0]), np.arange(len(blocks))
    matrix = np.zeros((n, c, n, c))
    matrix[j, :, j, :] = blocks
    return matrix.reshape(n * c, n * c)


def _end(kind: str, spring: np.ndarray, dashpot: np.ndarray, eta: float) -> tuple:
    if kind == "free":
        return 0 * spring, 0 * spring
    return (0 * spring, dashpot) if kind == "quiet" else (spring, eta * spring)
