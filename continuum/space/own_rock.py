"""Density and moduli of a script's rock in every cell, from its forms.

For displacements u = E x and v = F x the integrand of the stiffness is C_ijkl E_kl F_ij; for
translations u = v = e that of the mass is rho. Their means over each cell serve for stress,
sections, quiet sides and bounds, and check the forms: one density, and moduli that are symmetric,
not negative, and without resistance to rigid motion.
"""

from typing import Any

import numpy as np
import ufl
from ufl.algorithms.analysis import has_type

from jointwave.cases.errors import SceneError
from jointwave.cases.material.effective_medium import PAIRS
from jointwave.cases.scene_type import AnyScene
from jointwave.continuum.space import compat
from jointwave.continuum.space.model import Forms
from jointwave.continuum.space.rock import Material

DIGITS = 9  # in which the moduli of cells of one rock agree
ZERO = 1e-9  # tolerance of entries that must be zero, over the largest entry

#: A displacement linear in place: its translation [components] and gradient [components, d].
Motion = tuple[np.ndarray | float, np.ndarray | float]


class CellMeans:
    """The means of a bilinear form's integrand over cells, for displacements linear in place."""

    def __init__(self, space: Any, form: ufl.Form) -> None:
        domain, x = space.mesh, ufl.SpatialCoordinate(space.mesh)
        v, u = form.arguments()
        self.size, self.dim = u.ufl_shape[0], domain.geometry.dim
        shape = self.size, self.dim
        self.parts = [[compat.constant(domain, one) for one in (shape[:1], shape)] for _ in "uv"]
        moved = [t + ufl.dot(gradient, x) for t, gradient in self.parts]
        cells = ufl.Form([one for one in form.integrals() if one.integral_type() == "cell"])
        self.sums = compat.cell_sums(domain, ufl.replace(cells, {u: moved[0], v: moved[1]}))
        self.volume = compat.cell_sums(domain, compat.constant(domain, (), 1.0) * ufl.dx(domain))()

    def of(self, u: Motion, v: Motion) -> np.ndarray:
        """Return the means for two displacements [cells]."""
        for parts, given in zip(self.parts, (u, v), strict=True):
            for part, values in zip(parts, given, strict=True):
                part.value[...] = values
        return self.sums() / self.volume

    def table(self, motions: list[Motion]) -> np.ndarray:
        """Return the means for each displacement v with each u [cells, n, n]."""
        return np.moveaxis(np.array([[self.of(u, v) for u in motions] for v in motions]), 2, 0)


def strains_of(dim: int, size: int) -> np.ndarray:
    """Return displacement gradients of unit strains in Voigt's order [n, components, d]."""
    if dim == 1:
        return np.eye(size)[:, :, None]
    found = np.zeros((len(PAIRS[dim]), dim, dim))
    for one, (i, j) in zip(found, PAIRS[dim], strict=True):
        one[i, j] += 0.5
        one[j, i] += 0.5
    return found


def materials_of(
    scene: AnyScene, space: Any, forms: Forms, own: list[Material]
) -> tuple[list[Material], np.ndarray]:
    """Return the materials of forms on a space, and the index of each cell's material [cells].

    own : materials of the scene. Raises SceneError for forms that are not of rock, for damping that
    is no time constant times the stiffness, and for features that need the scene's own rock.
    """
    if not isinstance(forms, Forms):
        _refuse(scene, "the function must return Forms(mass, stiffness, damping)")
    for name, form in forms._asdict().items():
        if form is not None and not (isinstance(form, ufl.Form) and len(form.arguments()) == 2):
            _refuse(scene, f"{name} must be a form of a trial and a test function")
    _refuse_own_rock(scene, forms, own)
    density = _density(scene, forms.mass, space)
    means = CellMeans(space, forms.stiffness)
    strains = strains_of(means.dim, means.size)
    motions = [_rigid(space, strains), *((0.0, one) for one in strains)]
    table, (once, twice) = means.table(motions), ((0.0, k * strains.sum(axis=0)) for k in (1, 2))
    stiffness, most = table[:, 1:, 1:].copy(), np.abs(table).max()
    table[:, 1:, 1:] = 0.0
    least = np.linalg.eigvalsh(stiffness).min() if np.isfinite(most) else np.nan
    for wrong, why in (
        (min(least, 0.0), f"must not be negative: it has a modulus of {least:.3g} Pa"),
        (means.of(twice, once) - 2 * means.of(once, once), "must be linear in the displacement"),
        (table, "in the rock must be of strains, not of displacements or rotations"),
        (stiffness - stiffness.swapaxes(1, 2), "must be symmetric in trial and test function"),
    ):
        if not np.abs(wrong).max() <= ZERO * most:
            _refuse(scene, f"stiffness {why}")
    eta = np.zeros(len(density))
    if forms.damping is not None:
        damping, whole = CellMeans(space, forms.damping).table(motions), np.zeros_like(table)
        whole[:, 1:, 1:] = stiffness
        eta = np.trace(damping, axis1=1, axis2=2) / np.trace(stiffness, axis1=1, axis2=2)
        off = np.abs(damping - eta[:, None, None] * whole).max()
        if not off <= ZERO * np.abs(damping).max() or (eta < 0).any():
            _refuse(scene, "damping must be a time constant, not below 0, times the stiffness")
    rows = np.column_stack([density, eta, stiffness.reshape(len(density), -1)])
    scale = np.abs(rows).max(axis=0)
    alike = np.rint(10**DIGITS * rows / np.where(scale > 0, scale, 1.0))
    _, first, which = np.unique(alike, axis=0, return_index=True, return_inverse=True)
    each = [Material(float(density[k]), stiffness[k], float(eta[k])) for k in first]
    return each, which.reshape(-1)


def _rigid(space: Any, strains: np.ndarray) -> Motion:
    """Return a rigid motion with all translations and rotations: it detects any resistance."""
    size, dim = strains.shape[1:]
    share = np.sqrt([2.0, 3.0, 5.0])
    turns = [np.triu(one, 1) - np.tril(one, -1) for one in strains[dim:]] if dim > 1 else []
    turned = sum((k * one for k, one in zip(share, turns, strict=False)), np.zeros((size, dim)))
    return share[:size] * np.ptp(space.mesh.geometry.x, axis=0).max(), turned


def _density(scene: AnyScene, mass: ufl.Form, space: Any) -> np.ndarray:
    """Return the density of each cell [cells], kg/m3; raises SceneError for any other mass form."""
    means = CellMeans(space, mass)
    table = means.table([(one, 0.0) for one in np.eye(means.size)])
    found = table[:, 0, 0]
    off = np.abs(table - found[:, None, None] * np.eye(means.size)).max()
    if not found.min() > 0 or off > ZERO * found.max() or has_type(mass, ufl.classes.Derivative):
        _refuse(scene, "mass must be a density above 0, one for all directions, times u . v")
    return found


def _refuse_own_rock(scene: AnyScene, forms: Forms, own: list[Material]) -> None:
    """Raise SceneError for features that need the scene's [rock], which a script has replaced."""
    if forms.damping is None and any(one.time_constant for one in own):
        _refuse(scene, "the scene's dashpots of rock need Forms.damping", "damping")
    if scene.is_column and scene.ends.sides("quiet", "matched"):
        _refuse(scene, "absorbing ends have the impedance of the scene's rock", "ends")
    if scene.waves:
        _refuse(scene, "waves enter from the scene's rock: take a load on a side", "waves")
    if any(one.kind == "base" for one in scene.pushes):
        _refuse(scene, "a compliant base has the impedance of the scene's rock", "loads")


def _refuse(scene: AnyScene, why: str, key: str = "rock") -> None:
    raise SceneError(scene.where, key, None, f"rock of a script: {why}")
