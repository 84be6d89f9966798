"""The row of rigid blocks, linear and of small rotation: the matrices of its coupled freedoms.

Block i has the motion q_i = (u_x, u_y, u_z, theta_x, theta_y, theta_z) of its centroid. A face at
the distance h from it along y moves by u + theta x (0, h, 0); at contact j, from the start's face
(j = 0) over the joints to the end's (j = N), the relative motion is the right side's minus the
left side's, and point (x, z) of the contact moves by

    gap = r_y + phi_z x - phi_x z,   slip = (r_x + phi_y z, r_z - phi_y x)

Springs K and K_s per unit area at all points add up to the contact's matrix (Guo & Li 2002,
equations 1, 2); dashpots on a face likewise. Symmetrically placed points decouple stretching,
torsion and the two bendings, and each is a `Plane` of its own; axial motion is stretching alone.

The ends have no contact (free), a dashpot Z A on the block (quiet, equation 9), a dashpot Z A on a
massless face behind half a block 2k (matched), or half a block of rock to a wall (fixed).
"""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import block_diag, csr_array

from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.material.face import face_points
from jointwave.cases.material.jointed_rock import JointedRock
from jointwave.cases.schema.scene import Scene

STRETCHING = (1,)
#: Degrees of freedom that are coupled by the kinematics.
PLANES = {"none": ((0,), STRETCHING, (2,)), "small": (STRETCHING, (4,), (0, 5), (2, 3))}


@dataclass(frozen=True)
class Plane:
    """The c coupled degrees of freedom of N blocks, and the N + 1 contacts between them.

    Coordinates are the motions of the start's face, the N blocks and the end's face, c each.

    Attributes
    ----------
    mass : float array [N c], of the blocks, kg or kg m2; the faces have none.
    relative : sparse [(N + 1) c, (N + 2) c], relative motion of the contacts per coordinate.
    stiffness, viscosity : sparse [(N + 1) c, (N + 1) c] of the contacts, the ends included.
    faces : int array, indices of the coordinates of the massless faces of matched ends.
    dashpots : float array [len(faces), len(faces)], those behind these faces.
    """

    mass: np.ndarray
    relative: csr_array
    stiffness: csr_array
    viscosity: csr_array
    faces: np.ndarray
    dashpots: np.ndarray

    @property
    def blocks(self) -> slice:
        """Indices of the blocks' coordinates."""
        c = (self.relative.shape[1] - len(self.mass)) // 2
        return slice(c, c + len(self.mass))


def plane(scene: Scene, freedoms: tuple[int, ...], held: bool = False) -> Plane:
    """Return the part of a scene's row that moves in these degrees of freedom, without slip,
    opening and softening; held : as it stands under gravity, with ends that are fixed where they
    bear it, else free."""
    p, kinds = calibrate(scene), [str(scene.ends.start), str(scene.ends.end)]
    if held:
        holds = (kind == "fixed" or b for kind, b in zip(kinds, scene.bears, strict=True))
        kinds = ["fixed" if one else "free" for one in holds]
    n, c, own = p.block_count, len(freedoms), np.ix_(freedoms, freedoms)
    points = face_points(scene.pillar.side, scene.joints.contact_points, scene.joints.point_rule)

    def resistance(normal: float, shear: float) -> np.ndarray:
        return face_matrix(points, normal, shear)[own]

    etas = np.zeros(n - 1) if p.joint_time_constant is None else p.joint_time_constant
    springs = list(map(resistance, p.stiffness, p.shear_stiffness))
    rocks = p.at_start, p.at_end
    dashpots = [resistance(rock.impedance, rock.shear_impedance) for rock in rocks]
    start, end = map(_end, kinds, rocks, dashpots, [resistance] * 2)
    matched = np.repeat([kind == "matched" for kind in kinds], c)
    viscosity = [eta * spring for eta, spring in zip(etas, springs, strict=True)]
    inertia = np.array([p.inertia_across, p.inertia_along, p.inertia_across])
    masses = np.full(n, p.block_mass) if p.masses is None else p.masses
    mass = np.concatenate([np.tile(masses, (3, 1)), np.tile(inertia, (n, 1)).T])
    return Plane(
        mass=mass[list(freedoms)].T.ravel(),
        relative=_relative(n, *(to_face(h)[own] for h in (-p.spacing / 2, p.spacing / 2))),
        stiffness=csr_array(block_diag([start[0], *springs, end[0]])),
        viscosity=csr_array(block_diag([start[1], *viscosity, end[1]])),
        faces=np.r_[:c, (n + 1) * c : (n + 2) * c][matched],
        dashpots=block_diag(dashpots).toarray()[np.ix_(matched, matched)],
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


def _relative(n: int, left_face: np.ndarray, right_face: np.ndarray) -> csr_array:
    """Return the matrix from the coordinates of a plane to the contacts' relative motions."""
    c, j = len(left_face), np.arange(n)
    matrix = np.zeros((n + 1, c, n + 2, c))
    matrix[j, :, j + 1, :] = left_face
    matrix[j + 1, :, j + 1, :] = -right_face
    matrix[0, :, 0, :], matrix[n, :, n + 1, :] = -np.eye(c), np.eye(c)
    return csr_array(matrix.reshape((n + 1) * c, (n + 2) * c))


def _end(kind: str, rock: JointedRock, dashpot: np.ndarray, resistance) -> tuple:
    """Return the spring and the dashpot of the contact at an end."""
    if kind in ("free", "quiet"):
        return 0 * dashpot, dashpot if kind == "quiet" else 0 * dashpot
    spring = resistance(2 * rock.regular_stiffness, 2 * rock.regular_shear_stiffness)
    if kind == "fixed":
        spring = resistance(rock.wall_stiffness, rock.wall_shear_stiffness)
    return spring, (rock.time_constant or 0.0) * spring
