"""Plane waves through N parallel linear-slip joints at any angle, all reflections included.

R and T are the matrices of one joint (`oblique_joint.scattering`), R' and T' those from its other
side, which differ if the rocks on both sides do. E_i = diag(e^{i omega d_i q}) propagates P and SV,
or SH, over the spacing d_i, with the slownesses q across the joints of the rock there. Behind joint
i lies a stack of reflection R_{i+1}; from the last joint backwards

    Y_i = (I - R' E_i R_{i+1} E_i)^-1 T,   R_i = R + T' E_i R_{i+1} E_i Y_i

and forwards the waves behind each joint are D_i = Y_i E_{i-1} D_{i-1} (Kennett, Seismic Wave
Propagation in Stratified Media, 1983; at normal incidence Cai & Zhao, IJRMMS 37, 2000).
No exponential grows: evanescent waves only decay. Axes, signs and validity are those of
`oblique_joint`; joints and layers may differ, unless a wave in differing layers is evanescent.
"""

from collections.abc import Sequence

import numpy as np

from jointwave.cases.material.rock import ElasticRock, Values
from jointwave.compare.exact.plane.oblique_joint import Joint, layers_at_once, scattering
from jointwave.compare.exact.plane.pulse import Layers, PulseStack, axes_of
from jointwave.compare.exact.plane.waves import (
    KINDS,
    Kind,
    kinds_with,
    slowness_along,
    slownesses_across,
)


def coefficients(
    incidence: Kind,
    angle: Values,
    omega: Values,
    rock: ElasticRock,
    joints: list[Joint],
    spacings: np.ndarray,
) -> np.ndarray:
    """Return R_p, R_s at the first joint and T_p, T_s at the last one, of SH waves R and T, complex
    array [4 or 2, ...].

    incidence : "P", "SV" or "SH". angle : of travel from the normal, rad. omega : rad/s, Re >= 0;
    with a positive imaginary part it is a Laplace variable. These and rock are broadcast together.
    joints : in the order in which the wave meets them. spacings : between them, m, one less.
    """
    slowness, kinds = slowness_along(rock, incidence, angle), kinds_with(incidence)
    rocks, incident = [rock] * (len(joints) + 1), np.eye(len(kinds))[kinds.index(incidence)]
    down, up = layers(rocks, joints, spacings, slowness, omega, incident, kinds)
    return np.moveaxis(np.concatenate([up[0], down[-1]], axis=-1), -1, 0)


def layers(
    rocks: Sequence[ElasticRock],
    joints: list[Joint],
    spacings: np.ndarray,
    slowness: Values,
    omega: Values,
    incident: np.ndarray,
    kinds: tuple[Kind, ...] = KINDS,
) -> Layers:
    """Return the waves of all layers under an incident one [kinds] at the first joint."""
    R, Y = march(rocks, joints, spacings, slowness, omega, kinds)
    E = _phases(rocks, spacings, slowness, omega, kinds)
    down, up = [np.broadcast_to(incident, Y[0].shape[:-1])], [R[0] @ incident]
    meets = down[0]
    for i, y in enumerate(Y):
        down.append((y @ meets[..., None])[..., 0])
        if i < len(E):
            meets = E[i] * down[-1]
            up.append((R[i + 1] @ meets[..., None])[..., 0])
    return Layers(np.stack(down), np.stack([*up, np.zeros_like(up[0])]))


def march(
    rocks: Sequence[ElasticRock],
    joints: list[Joint],
    spacings: np.ndarray,
    slowness: Values,
    omega: Values,
    kinds: tuple[Kind, ...] = KINDS,
) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """Return R_i and Y_i of every joint, complex arrays [..., kinds, kinds].

    rocks : of the layers, one more than joints. slowness : s/m.
    """
    R, T = scattering(rocks[-2], joints[-1], slowness, omega, rocks[-1], kinds)
    reflected, behind = [R], [T]
    E = _phases(rocks, spacings, slowness, omega, kinds)
    for k in range(len(joints) - 2, -1, -1):
        R, T = scattering(rocks[k], joints[k], slowness, omega, rocks[k + 1], kinds)
        back, returned = R, T
        if rocks[k] is not rocks[k + 1]:
            back, returned = scattering(rocks[k + 1], joints[k], slowness, omega, rocks[k], kinds)
        rest = E[k][..., :, None] * reflected[0] * E[k][..., None, :]
        Y = np.linalg.solve(np.eye(len(kinds)) - back @ rest, T)
        reflected.insert(0, R + returned @ rest @ Y)
        behind.insert(0, Y)
    return reflected, behind


def stack_of(
    rocks: Sequence[ElasticRock],
    joints: list[Joint],
    kind: Kind,
    direction: np.ndarray,
    normal: np.ndarray,
    offsets: np.ndarray,
    polarisation: np.ndarray | None = None,
) -> PulseStack:
    """Return the joints in the order in which a pulse meets them.

    Parameters
    ----------
    rocks : of the layers in the order of `offsets`, [N + 1].
    joints : in the order of `offsets`, [N].
    kind, direction, polarisation : of the pulse, as of `axes_of`.
    normal : of the joints, unit vector [d].
    offsets : of the joints from the origin along the normal, ascending, m, [N].
    """
    depths, met = np.asarray(offsets, dtype=float), joints
    if np.asarray(direction) @ normal < 0:
        depths, met, rocks = -depths[::-1], met[::-1], rocks[::-1]
    axes = axes_of(rocks[0], kind, direction, normal, polarisation)
    of = rocks, met, np.diff(depths), axes.slowness

    def at(omega: np.ndarray) -> Layers:
        return layers(*of, omega, axes.incident, axes.kinds)

    return PulseStack(axes, depths, at, layers_at_once(rocks, met[0], axes), rocks)


def _phases(
    rocks: Sequence[ElasticRock],
    spacings: np.ndarray,
    slowness: Values,
    omega: Values,
    kinds: tuple[Kind, ...],
) -> list[np.ndarray]:
    """Return the diagonals of E_i, complex arrays [..., kinds]; rocks : of all layers."""
    turned = 1j * np.asarray(omega)[..., None]
    return [
        np.exp(turned * d * slownesses_across(rock, slowness, kinds))
        for d, rock in zip(spacings, rocks[1:-1], strict=True)
    ]
