"""Joint sets of rigid blocks that come nearest to a rock mass, and the part that they lack.

Rigid blocks have no S0 of their own (`effective_medium`): all compliance is that of their joints,

    minimise || sum over sets of (Z_N opening(n) + Z_T sliding(n)) - S ||,   Z_N, Z_T >= 0

in the norm of the tensor S_ijkl, by non-negative least squares (Lawson & Hanson, Solving Least
Squares Problems, 1974). Of equally good fits the one of least norm is taken: orthogonal sets share
their shear compliance equally. What is left over is known before a run; of two orthogonal sets in
isotropic rock it is C_12, their lack of a Poisson effect.
"""

from typing import NamedTuple

import numpy as np

from jointwave.cases.material.effective_medium import opening, sliding

LEAST = 1e-7  #: weight of the fit's own norm
PRECISE = 1e-15  #: accuracy of least squares relative to the largest number: round-off


class RigidFit(NamedTuple):
    """Z_N and Z_T of each set [sets, 2], 1/Pa, and what they lack of S over S, norms of tensors."""

    compliance: np.ndarray
    left_over: float


def rigid_fit(compliance: np.ndarray, normals: np.ndarray) -> RigidFit:
    """Return the sets of rigid blocks nearest to a compliance.

    compliance : S in Kelvin's form (1/Pa), [3, 3] or [6, 6]. normals : unit vectors [sets, d].
    """
    from scipy.optimize import nnls

    size = np.linalg.norm(compliance)
    aim, parts = np.ravel(compliance) / size, _forms(normals).reshape(2 * len(normals), -1)
    A = np.concatenate([parts.T, LEAST * np.eye(len(parts))])
    Z, _ = nnls(A, np.append(aim, np.zeros(len(parts))))
    return RigidFit(size * Z.reshape(-1, 2), float(np.linalg.norm(Z @ parts - aim)))


def nearest_stiffness(stiffness: np.ndarray, normals: np.ndarray) -> RigidFit:
    """Return the sets of rigid blocks whose stiffness, not compliance, is nearest to one.

    stiffness : C in Kelvin's form (Pa), [3, 3] or [6, 6]. normals : unit vectors [sets, d].

    Strains that the sets cannot take on are zero, as in rock that is confined: of orthogonal sets
    in isotropic rock, waves along the normals have the rock's own speeds, which follow from C_11
    and not from 1 / S_11. What is left over is again a part of the whole, those strains included.
    """
    from scipy.optimize import least_squares

    C, size, forms = np.asarray(stiffness), np.linalg.norm(stiffness), _forms(normals)
    reach, shapes = np.linalg.eigh(forms.sum(axis=0))
    basis = shapes[:, reach > LEAST * reach[-1]]
    parts, aim = basis.T @ forms @ basis, basis.T @ C @ basis / size
    start = rigid_fit(np.linalg.inv(C) * size, normals).compliance.ravel()
    scale, small = start.max(), LEAST * np.eye(len(start))

    def stiffness_of(z: np.ndarray) -> np.ndarray:
        return np.linalg.inv(np.einsum("k,kij->ij", scale * z, parts))

    def misfit(z: np.ndarray) -> np.ndarray:
        return np.append((stiffness_of(z) - aim).ravel(), LEAST * z)

    def jacobian(z: np.ndarray) -> np.ndarray:
        own = stiffness_of(z)
        slope = -scale * np.array([(own @ part @ own).ravel() for part in parts]).T
        return np.append(slope, small, axis=0)

    z = least_squares(
        misfit, np.maximum(start / scale, LEAST), jacobian, (0.0, np.inf),
        xtol=PRECISE, ftol=PRECISE, gtol=PRECISE,
    ).x  # fmt: skip
    missing = float(1 - (aim**2).sum() + ((stiffness_of(z) - aim) ** 2).sum())
    # Of all sets with this compliance those of least norm.
    found = rigid_fit(np.einsum("k,kij->ij", scale / size * z, forms), normals)
    return found._replace(left_over=max(missing, 0.0) ** 0.5)


def _forms(normals: np.ndarray) -> np.ndarray:
    """Return the compliances of sets that open, and that slide, by one, in turn [2 sets, k, k]."""
    return np.array([form(n) for n in normals for form in (opening, sliding)])
