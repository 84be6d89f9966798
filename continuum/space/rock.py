"""Rock as bilinear UFL forms: mass, stiffness and Kelvin-Voigt damping.

    M(u, v) = rho u . v dx,   K(u, v) = sigma(u) : eps(v) dx,   C(u, v) = eta sigma(u) : eps(v) dx

with eps(u) = sym(grad u). Isotropic rock has sigma = lambda tr(eps) I + 2 mu eps: with Lame's
constants in plane strain and in space, with lambda = E nu / (1 - nu^2) in plane stress. Anisotropic
rock has sigma_ij = C_ijkl eps_kl. A bar has sigma = E u' along it, and G u' across it.
"""

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np
import ufl
from ufl import dx, grad, inner, sym

from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.material.constant_q import mechanisms_of
from jointwave.cases.material.effective_medium import compliant, stiffness, tensor
from jointwave.cases.material.jointed_rock import JointedRock
from jointwave.cases.material.rock import (
    ElasticRock,
    elastic_rock,
    shear_modulus,
    speeds_from_modulus,
)
from jointwave.cases.partition.joints import within
from jointwave.cases.schema.joint import JointSet
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.cases.schema.scene import Scene
from jointwave.continuum.joints import layers_of
from jointwave.continuum.space.compat import cell_constants
from jointwave.continuum.space.model import Forms

#: Rock of a script: a function of a scene and a space of displacements.
Rock = Callable[[Any, Any], Forms]


class Material(NamedTuple):
    """Elastic rock: density, kg/m3; stiffness in Voigt's form [n, n], Pa; Kelvin-Voigt time, s."""

    density: float
    stiffness: np.ndarray
    time_constant: float = 0.0


def isotropic(space: Any, density: Any, lame: Any, shear: Any, time_constant: Any = None) -> Forms:
    """Return isotropic rock: density, kg/m3; Lame's constants lambda and mu, Pa; Kelvin-Voigt time
    constant, s. Each is a number, a function or another UFL expression."""

    def stress(eps: Any) -> Any:
        return lame * ufl.tr(eps) * ufl.Identity(eps.ufl_shape[0]) + 2 * shear * eps

    return elastic(space, density, stress, time_constant)


def anisotropic(space: Any, density: Any, moduli: Any, time_constant: Any = None) -> Forms:
    """Return anisotropic rock; moduli : C_ijkl, Pa, an array or a UFL tensor [d, d, d, d]."""
    if isinstance(moduli, np.ndarray):
        moduli = ufl.as_tensor(moduli.tolist())
    i, j, k, m = ufl.indices(4)

    def stress(eps: Any) -> Any:
        return ufl.as_tensor(moduli[i, j, k, m] * eps[k, m], (i, j))

    return elastic(space, density, stress, time_constant)


def elastic(space: Any, density: Any, stress: Callable[[Any], Any], time_constant: Any) -> Forms:
    """Return rock from its density and stress, a function linear in the strain (u' in a bar)."""
    u, v = ufl.TrialFunction(space), ufl.TestFunction(space)
    stiffness = inner(stress(strain(u)), strain(v))
    damping = None if time_constant is None else time_constant * stiffness * dx
    return Forms(density * inner(u, v) * dx, stiffness * dx, damping)


def strain(u: Any) -> Any:
    """Return the strain of a displacement, sym(grad u); u' in a mesh of one dimension."""
    gradient = grad(u)
    return gradient[:, 0] if gradient.ufl_shape[1] == 1 else sym(gradient)


def rock_of_cells(space: Any, materials: list[Material], which: np.ndarray) -> Forms:
    """Return rock from the index of the material of each cell of the mesh [cells]."""
    density, eta = np.array([[m.density, m.time_constant] for m in materials])[which].T
    stiffness = np.array([m.stiffness for m in materials])[which]
    found = _of_cells(space, density, stiffness)
    if not eta.any():
        return found
    # The same form as the stiffness with other numbers, so that it is compiled once for both.
    damping = _of_cells(space, density, eta[:, None, None] * stiffness)
    return found._replace(damping=damping.stiffness)


def _of_cells(space: Any, density: np.ndarray, stiffness: np.ndarray) -> Forms:
    size = stiffness.shape[1]
    upper, number = np.triu_indices(size), np.zeros((size, size), int)
    constants = cell_constants(space.mesh, stiffness[:, *upper])
    number[upper] = range(len(upper[0]))
    number = np.maximum(number, number.T)
    rho = cell_constants(space.mesh, density[:, None])[0]
    if space.mesh.geometry.dim == 1:
        C = ufl.as_matrix([[constants[int(k)] for k in row] for row in number])
        return elastic(space, rho, lambda slope: C * slope, None)
    moduli = [[[[constants[int(k)] for k in a] for a in b] for b in c] for c in tensor(number)]
    return anisotropic(space, rho, ufl.as_tensor(moduli))


def rock_mass(scene: RockMass, smeared: list[JointSet], model: str) -> list[Material]:
    """Return the rock of each region of a rock mass, and last of the rest, each as an effective
    medium with the joint sets that are not resolved."""
    dim, relaxes = scene.domain.dimension, mechanisms_of(scene, model)
    unrelaxed = 1.0 if relaxes is None else relaxes.unrelaxed
    rayleigh = scene.damping.rayleigh
    eta = 0.0 if rayleigh is None else rayleigh.coefficients[1]
    return [
        Material(
            one.rock.density,
            unrelaxed * stiffness(elastic_rock(one.rock), compliant(one.joint_sets), dim),
            eta,
        )
        for one in within(scene, smeared)
    ]


def pillar(
    scene: Scene, model: str, components: int, dim: int, less: Mapping[int, float]
) -> list[Material]:
    """Return the rock of a pillar's segments, intact ("jointed") or homogenised, of its layers, and
    of homogenised blocks without part of their joints; less : this part, in halves of a joint.

    A layer of thickness h has the modulus K_n h and Poisson's ratio 0: the rock on both sides keeps
    a thin layer from widening, and K_n is its whole stiffness. Rock with a quality factor has its
    unrelaxed modulus and no dashpots.
    """
    p, relaxes, found = calibrate(scene), mechanisms_of(scene, model), []

    def add(density: float, modulus: float, poisson: float, eta: float) -> None:
        shear = shear_modulus(modulus, poisson)
        if dim == 1:  # E along a bar, and G across it where it has three components
            C = np.diag([modulus] if components == 1 else [shear, modulus, shear])
        elif scene.motion.rotation == "none":  # plane sections, free to widen
            C = np.diag([modulus] * dim + [shear] * (dim * (dim - 1) // 2))
        elif dim == 3:
            speeds = speeds_from_modulus(modulus, poisson, density)
            C = stiffness(ElasticRock(density, *speeds), [], 3)
        else:  # plane stress
            sheet = np.array([[1, poisson, 0], [poisson, 1, 0], [0, 0, (1 - poisson) / 2]])
            C = modulus / (1 - poisson**2) * sheet
        found.append(Material(density, C, eta))

    def add_rock(one: JointedRock, modulus: float, poisson: float) -> None:
        if relaxes is None:
            add(one.density, modulus, poisson, one.time_constant or 0.0)
        else:
            add(one.density, modulus * relaxes.unrelaxed, poisson, 0.0)

    for one, part in zip(p.each, scene.parts, strict=True):
        if model == "jointed":
            assert one.intact_modulus is not None
            add_rock(one, one.intact_modulus, scene.alone(part).rock.intact_poisson)
        else:
            add_rock(one, one.modulus, one.poisson)
    soft = dict(zip(p.soft.tolist(), scene.soft_layers, strict=True))
    for joint, thickness in layers_of(scene).items():
        normal = soft[joint].own_stiffness(p.spacing)
        assert normal is not None
        etas = p.joint_time_constant
        add(p.density, normal * thickness, 0.0, 0.0 if etas is None else float(etas[joint]))
    for block, halves in less.items():
        one = p.each[p.segment[block]]
        moduli = np.array([one.modulus, one.shear_modulus])
        E, G = 1 / (1 / moduli - halves * p.half_joint[:, block] / one.spacing)
        add_rock(one, E, E / G / 2 - 1)
    return found
