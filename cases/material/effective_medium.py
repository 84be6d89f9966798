"""Effective medium of joint sets: long waves in rock with any number of sets of parallel joints.

Each set with unit normal n adds its mean jump to the strain (Schoenberg & Sayers, Geophysics 60,
1995; Sayers & Kachanov, JGR 100, 1995):

    S_ijkl = S0_ijkl + sum over sets of (alpha_ik n_j n_l + alpha_jk n_i n_l + alpha_il n_j n_k
             + alpha_jl n_i n_k) / 4,   alpha = Z_T (I - n n) + Z_N n n
    Z_N = 1/(spacing K_n),   Z_T = 1/(spacing K_s)

Wave speeds follow from Christoffel's equation, C_ijkl n_j n_l g_k = rho c^2 g_i. Normals have two
components in plane strain and three in space; normals in a plane give the same result either way.
Valid for waves long against the spacings, and joints that do not end at one another.

Voigt's form has the order 11, 22, 12 or 11, 22, 33, 23, 13, 12: C maps engineering shear strains,
gamma_12 = 2 e_12, to stresses.

Rigid blocks have no compliance S0: their joints carry all of it. The joints nearest to a rock mass

    minimise || sum over sets of (Z_N opening(n) + Z_T sliding(n)) - S ||,   Z_N, Z_T >= 0

in the norm of the tensor S_ijkl, by non-negative least squares (Lawson & Hanson, Solving Least
Squares Problems, 1974). Of equally good fits the one of least norm is taken: orthogonal sets share
their shear compliance equally. The residual is known before a run; for two orthogonal sets in
isotropic rock it is C_12, their missing Poisson effect.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from jointwave.cases.material.rock import ElasticRock, elastic_rock
from jointwave.cases.partition.joints import within
from jointwave.cases.schema import joint as schema
from jointwave.cases.schema.rock_mass import RockMass

DIRECTIONS = 36  # in which the least speed is searched, over half a circle
RIGID = 1e-9  # compliance of rigid bodies over the largest one of the joints
LEAST = 1e-15  # 1/Pa, stands for the largest compliance if there is none
OF_NORM = 1e-7  # weight of the solution's norm in the fit
PRECISE = 1e-15  # accuracy of least squares relative to the largest number: round-off
PAIRS = {2: ((0, 0), (1, 1), (0, 1)), 3: ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))}


@dataclass(frozen=True)
class JointSet:
    """A set of parallel joints: unit normal [d], compliances Z_N and Z_T (1/Pa)."""

    normal: np.ndarray
    normal_compliance: float = 0.0
    shear_compliance: float = 0.0


def compliant(sets: Iterable[schema.JointSet], stress: np.ndarray | None = None) -> list[JointSet]:
    """Return the sets of a scene that have a spacing; a single joint is not a medium.

    stress : that closes the joints, compression positive [d, d], Pa.
    """
    found = []
    for one in sets:
        if one.spacing:
            assert one.shear_stiffness
            own = closed_stiffness(one, stress), one.shear_stiffness
            found.append(JointSet(one.normal, *(1 / (one.spacing * k) for k in own)))
    return found


def closed_stiffness(one: schema.JointSet, stress: np.ndarray | None) -> float:
    """Return the normal stiffness of joints under a stress, compression positive [d, d], Pa: k (1 +
    sigma / k d_m)^2, Pa/m, for joints that stiffen as they close."""
    K, n = one.normal_stiffness or 0.0, one.normal
    if K and one.maximum_closure and stress is not None:
        K *= (1 + max(n @ stress @ n, 0.0) / (K * one.maximum_closure)) ** 2
    return K


def slowest(scene: RockMass) -> float:
    """Return the least speed (m/s) of long waves through joint sets with a spacing, over directions
    on half a circle or sphere."""
    dim = scene.domain.dimension
    level = np.linspace(0.0, np.pi, DIRECTIONS, endpoint=False)
    directions = np.stack([np.cos(level), np.sin(level)], axis=-1)
    if dim == 3:  # circles of equal height
        level, turned = np.meshgrid(level, level)
        across = np.sin(level) * np.cos(turned), np.sin(level) * np.sin(turned)
        directions = np.stack([*across, np.cos(level)], axis=-1).reshape(-1, 3)
    media = (
        (stiffness(elastic_rock(one.rock), compliant(one.joint_sets), dim), one.rock.density)
        for one in within(scene, scene.joint_sets)
    )
    return min(float(speeds(medium, rho, directions)[0].min()) for medium, rho in media)


def added(one: JointSet) -> np.ndarray:
    """Return a set's compliance in Kelvin's form, orthogonal components, [3, 3] or [6, 6], 1/Pa."""
    n = one.normal
    return one.normal_compliance * opening(n) + one.shear_compliance * sliding(n)


def intact(rock: ElasticRock, dimension: int = 2) -> np.ndarray:
    """Return the stiffness of rock without joints in Kelvin's form, Pa."""
    pairs = PAIRS[dimension]
    isotropic = np.array([float(i == j) for i, j in pairs])
    return rock.lame * np.outer(isotropic, isotropic) + 2 * rock.shear_modulus * np.eye(len(pairs))


def opening(normal: np.ndarray) -> np.ndarray:
    """Return the compliance of a set with Z_N = 1 and Z_T = 0, in Kelvin's form."""
    n = np.asarray(normal, dtype=float)
    return _kelvin(np.einsum("i,j,k,l->ijkl", n, n, n, n))


def sliding(normal: np.ndarray) -> np.ndarray:
    """Return the compliance of a set with Z_N = 0 and Z_T = 1, in Kelvin's form."""
    n = np.asarray(normal, dtype=float)
    one = np.einsum("ik,j,l->ijkl", np.eye(len(n)) - np.outer(n, n), n, n)
    orders = (0, 1, 2, 3), (1, 0, 2, 3), (0, 1, 3, 2), (1, 0, 3, 2)
    return _kelvin(sum(one.transpose(order) for order in orders) / 4)


def stiffness(rock: ElasticRock, sets: list[JointSet], dimension: int = 2) -> np.ndarray:
    """Return C of the effective medium in Voigt's form, Pa: [3, 3] or [6, 6]."""
    scale = _scale(dimension)
    return with_joints(intact(rock, dimension) / np.outer(scale, scale), sets)


def with_joints(C: np.ndarray, sets: list[JointSet]) -> np.ndarray:
    """Return C of joint sets in rock with stiffness C, both in Voigt's form, Pa."""
    scale = _scale({3: 2, 6: 3}[len(C)])
    kelvin = np.outer(scale, scale)
    return np.linalg.inv(sum(map(added, sets), start=np.linalg.inv(C * kelvin))) / kelvin


def joints_alone(sets: list[JointSet], dimension: int = 2) -> np.ndarray:
    """Return C of rigid bodies with joints, Voigt's form, Pa; huge where no joint set yields."""
    scale = _scale(dimension)
    S = sum(map(added, sets), start=np.zeros((len(scale), len(scale))))
    S = S + RIGID * (np.abs(S).max() or LEAST) * np.eye(len(scale))
    return np.linalg.inv(S) / np.outer(scale, scale)


def christoffel(C: np.ndarray, directions: np.ndarray) -> np.ndarray:
    """Return C_ijkl n_j n_l, arrays [..., d, d] in Pa; C in Voigt's form, directions [..., d]."""
    n = np.asarray(directions, dtype=float)
    n = n / np.linalg.norm(n, axis=-1, keepdims=True)
    return np.einsum("ijkl,...j,...l->...ik", tensor(C), n, n)


def speeds(C: np.ndarray, density: float, directions: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the phase speeds [..., d] (m/s), ascending, and polarisations [..., d, wave]."""
    squares, shapes = np.linalg.eigh(christoffel(C, directions) / density)
    if squares.min() < -1e-9 * squares.max():
        raise ValueError("the stiffness is not positive: no real waves in some direction")
    return np.sqrt(np.maximum(squares, 0.0)), shapes


def impedance(C: np.ndarray, density: float, directions: np.ndarray) -> np.ndarray:
    """Return the impedances of plane waves along directions [..., d], tensors [..., d, d], Pa s/m:
    the square root of density times Christoffel's tensor."""
    values, shapes = np.linalg.eigh(density * christoffel(C, directions))
    return np.einsum("...ik,...k,...jk->...ij", shapes, np.sqrt(np.maximum(values, 0.0)), shapes)


def tensor(C: np.ndarray) -> np.ndarray:
    """Return C_ijkl [d, d, d, d] from Voigt's form."""
    d = {3: 2, 6: 3}[len(C)]
    i, j = np.transpose(PAIRS[d])
    at = np.empty((d, d), np.int64)
    at[i, j] = at[j, i] = np.arange(len(C))
    return np.asarray(C)[at[:, :, None, None], at]


def _scale(dimension: int) -> np.ndarray:
    """Return Kelvin's factors: sqrt(2) for shear components."""
    return np.array([1.0 if i == j else np.sqrt(2) for i, j in PAIRS[dimension]])


def _kelvin(full: np.ndarray) -> np.ndarray:
    """Return Kelvin's form of a tensor [d, d, d, d] with both minor symmetries."""
    pairs, scale = PAIRS[len(full)], _scale(len(full))
    return np.array([[full[a + b] for b in pairs] for a in pairs]) * np.outer(scale, scale)


class RigidFit(NamedTuple):
    """Z_N and Z_T of each set [sets, 2], 1/Pa, and the residual, relative in the tensor norm."""

    compliance: np.ndarray
    left_over: float


def rigid_fit(compliance: np.ndarray, normals: np.ndarray) -> RigidFit:
    """Return the joint sets of rigid blocks that are nearest to a compliance.

    compliance : S in Kelvin's form (1/Pa), [3, 3] or [6, 6]. normals : unit vectors [sets, d].
    """
    from scipy.optimize import nnls

    size = np.linalg.norm(compliance)
    aim, parts = np.ravel(compliance) / size, _forms(normals).reshape(2 * len(normals), -1)
    A = np.concatenate([parts.T, OF_NORM * np.eye(len(parts))])
    Z, _ = nnls(A, np.append(aim, np.zeros(len(parts))))
    return RigidFit(size * Z.reshape(-1, 2), float(np.linalg.norm(Z @ parts - aim)))


def nearest_stiffness(stiffness: np.ndarray, normals: np.ndarray) -> RigidFit:
    """Return the joint sets of rigid blocks that are nearest to a stiffness instead of a
    compliance.

    stiffness : C in Kelvin's form (Pa), [3, 3] or [6, 6]. normals : unit vectors [sets, d].

    Strains to which no set yields are zero, as in confined rock: waves along the normals of
    orthogonal sets have isotropic rock's speeds, from C_11 and not 1 / S_11. The residual is
    relative to the whole stiffness, those strains included.
    """
    from scipy.optimize import least_squares

    C, size, forms = np.asarray(stiffness), np.linalg.norm(stiffness), _forms(normals)
    reach, shapes = np.linalg.eigh(forms.sum(axis=0))
    basis = shapes[:, reach > OF_NORM * reach[-1]]
    parts, aim = basis.T @ forms @ basis, basis.T @ C @ basis / size
    start = rigid_fit(np.linalg.inv(C) * size, normals).compliance.ravel()
    scale, small = start.max(), OF_NORM * np.eye(len(start))

    def stiffness_of(z: np.ndarray) -> np.ndarray:
        return np.linalg.inv(np.einsum("k,kij->ij", scale * z, parts))

    def misfit(z: np.ndarray) -> np.ndarray:
        return np.append((stiffness_of(z) - aim).ravel(), OF_NORM * z)

    def jacobian(z: np.ndarray) -> np.ndarray:
        own = stiffness_of(z)
        slope = -scale * np.array([(own @ part @ own).ravel() for part in parts]).T
        return np.append(slope, small, axis=0)

    z = least_squares(
        misfit, np.maximum(start / scale, OF_NORM), jacobian, (0.0, np.inf),
        xtol=PRECISE, ftol=PRECISE, gtol=PRECISE,
    ).x  # fmt: skip
    missing = float(1 - (aim**2).sum() + ((stiffness_of(z) - aim) ** 2).sum())
    # Among all solutions with this compliance take the one of least norm.
    found = rigid_fit(np.einsum("k,kij->ij", scale / size * z, forms), normals)
    return found._replace(left_over=max(missing, 0.0) ** 0.5)


def _forms(normals: np.ndarray) -> np.ndarray:
    """Return the unit compliances of opening and of sliding of each set, in turn [2 sets, k, k]."""
    return np.array([form(n) for n in normals for form in (opening, sliding)])
