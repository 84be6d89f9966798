"""Plane waves through N parallel linear-slip joints at any angle, all reflections included.

R and T are the matrices of one joint (`oblique_joint.scattering`), R' and T' those from its other
side, which differ if the rocks on both sides do. E_i = diag(e^{i omega d_i q}) propagates P and SV,
or SH, over the spacing d_i, with the rock's slownesses q across the joints. Behind joint i lies a
stack of reflection R_{i+1}; from the last joint backwards

    Y_i = (I - R' E_i R_{i+1} E_i)^-1 T,   R_i = R + T' E_i R_{i+1} E_i Y_i

and forwards the waves behind each joint are D_i = Y_i E_{i-1} D_{i-1} (Kennett, Seismic Wave
Propagation in Stratified Media, 1983; at normal incidence Cai & Zhao, IJRMMS 37, 2000). No
exponential grows: evanescent waves only decay. Axes, signs and validity are those of
`oblique_joint`; joints and layers may differ, unless a wave in differing layers is evanescent.

A pulse is a sum of such harmonic waves. At (x, z) in the axes (t, n) of the joints

    v(t) = sum over waves of g A e^{i omega (p x +- q z)},   stress likewise (`waves.stress`).
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from jointwave.cases.incident import in_components
from jointwave.cases.material.rock import ElasticRock, Values
from jointwave.compare.exact.plane import waves
from jointwave.compare.exact.plane.oblique_joint import Joint, scattering


class Layers(NamedTuple):
    """Amplitudes [layers, omega, kinds] along +n at each layer's first joint, along -n at its last;
    in the half-spaces both are at their only joint."""

    down: np.ndarray
    up: np.ndarray


def coefficients(
    incidence: waves.Kind,
    angle: Values,
    omega: Values,
    rock: ElasticRock,
    joints: list[Joint],
    spacings: np.ndarray,
) -> np.ndarray:
    """Return R_p, R_s at the first joint and T_p, T_s at the last one, for SH waves R and T,
    complex array [4 or 2, ...].

    incidence : "P", "SV" or "SH". angle : of travel from the normal, rad. omega : rad/s, Re >= 0,
    and Im >= 0 as for Laplace variables. angle, omega and rock are broadcast together. joints : in
    the order in which the wave meets them. spacings : between them, m, one less.
    """
    slowness, kinds = waves.slowness_along(rock, incidence, angle), waves.kinds_with(incidence)
    rocks, incident = [rock] * (len(joints) + 1), np.eye(len(kinds))[kinds.index(incidence)]
    down, up = layers(rocks, joints, spacings, slowness, omega, incident, kinds)
    return np.moveaxis(np.concatenate([up[0], down[-1]], axis=-1), -1, 0)


def layers(
    rocks: Sequence[ElasticRock],
    joints: Sequence[Joint],
    spacings: np.ndarray,
    slowness: Values,
    omega: Values,
    incident: np.ndarray,
    kinds: tuple[waves.Kind, ...] = waves.KINDS,
) -> Layers:
    """Return the waves of all layers for an incident wave [kinds] at the first joint.

    rocks : of the layers, one more than joints. slowness : s/m.
    """
    turned, inner = 1j * np.asarray(omega)[..., None], list(zip(spacings, rocks[1:-1], strict=True))
    E = [np.exp(turned * d * waves.slownesses_across(rock, slowness, kinds)) for d, rock in inner]
    R, T = scattering(rocks[-2], joints[-1], slowness, omega, rocks[-1], kinds)
    reflected, behind = [R], [T]
    for k in range(len(joints) - 2, -1, -1):
        R, T = scattering(rocks[k], joints[k], slowness, omega, rocks[k + 1], kinds)
        back, returned = R, T
        if rocks[k] is not rocks[k + 1]:
            back, returned = scattering(rocks[k + 1], joints[k], slowness, omega, rocks[k], kinds)
        rest = E[k][..., :, None] * reflected[0] * E[k][..., None, :]
        Y = np.linalg.solve(np.eye(len(kinds)) - back @ rest, T)
        reflected.insert(0, R + returned @ rest @ Y)
        behind.insert(0, Y)
    meets = np.broadcast_to(incident, behind[0].shape[:-1])
    down, up = [meets], [reflected[0] @ incident]
    for i, Y in enumerate(behind):
        down.append((Y @ meets[..., None])[..., 0])
        if i < len(E):
            meets = E[i] * down[-1]
            up.append((reflected[i + 1] @ meets[..., None])[..., 0])
    return Layers(np.stack(down), np.stack([*up, np.zeros_like(up[0])]))


class PulseStack(NamedTuple):
    """Joints in the order in which a pulse meets them.

    rocks : of the layers [N + 1], equal if a wave is evanescent. joints, depths (along n, m) : [N].
    """

    axes: waves.Axes
    rocks: Sequence[ElasticRock]
    joints: Sequence[Joint]
    depths: np.ndarray

    def layers(self, omega: np.ndarray) -> Layers:
        """Return the waves of all layers at omega (rad/s) for a unit wave at the first joint."""
        axes, spacings = self.axes, np.diff(self.depths)
        of = self.rocks, self.joints, spacings, axes.slowness, omega, axes.incident
        return layers(*of, axes.kinds)

    @property
    def at_once(self) -> Layers:
        """Real amplitudes [layers, kinds] that follow a pulse without delay: reflection and
        transmission at the first joint in the limit of high frequencies, in which springs do not
        act. If P is evanescent, the incident wave only."""
        axes, first = self.axes, self.joints[0]
        down, up = np.zeros((2, len(self.rocks), len(axes.kinds)))
        down[0] = axes.incident
        if not self.is_evanescent:
            springs = first.normal_stiffness, first.shear_stiffness
            K_n, K_s = (np.where(np.isinf(K), K, 0.0) for K in springs)
            bare = replace(first, normal_stiffness=K_n, shear_stiffness=K_s)
            here, there = self.rocks[:2]
            R, T = scattering(here, bare, axes.slowness, 1.0, there, axes.kinds)
            up[0], down[1] = (R @ axes.incident).real, (T @ axes.incident).real
        return Layers(down, up)

    @property
    def slownesses(self) -> np.ndarray:
        """Slownesses across the joints in every layer, complex [layers, kinds], s/m."""
        p, kinds = self.axes.slowness, self.axes.kinds
        return np.array([waves.slownesses_across(one, p, kinds) for one in self.rocks])

    @property
    def lead(self) -> complex:
        """Arrival time of the pulse at the first joint, s."""
        return self.slownesses[0, self.axes.kinds.index(self.axes.kind)] * self.depths[0]

    @property
    def is_evanescent(self) -> bool:
        """Whether P waves decay away from the joints."""
        return self.axes.kinds == waves.KINDS and waves.is_evanescent(
            self.rocks[0], self.axes.slowness
        )

    @property
    def modes(self) -> np.ndarray:
        """Velocity, and stress over the first rock's Z_p, of unit waves of all kinds, along +n and
        then along -n [layers, waves, d + components], in the order of a `WaveMotion`."""
        axes, found = self.axes, []
        for rock, across in zip(self.rocks, self.slownesses, strict=True):
            g = np.tile(axes.rows[2:] + 0j, (2, 1))
            if axes.kinds == waves.KINDS:
                g = waves.polarisations(rock, axes.slowness).reshape(4, 2) @ axes.rows[:2]
            along = np.full(len(g), axes.slowness)
            s = np.stack([along, np.concatenate([across, -across])], axis=-1) @ axes.rows[:2]
            tensor = waves.stress(rock, s, g) / self.rocks[0].p_impedance
            found.append(np.concatenate([g, in_components(tensor)], axis=1))
        return np.array(found)


def stack_of(
    rocks: Sequence[ElasticRock],
    joints: list[Joint],
    kind: waves.Kind,
    direction: np.ndarray,
    normal: np.ndarray,
    offsets: np.ndarray,
    polarisation: np.ndarray | None = None,
) -> PulseStack:
    """Return the joints in the order in which a pulse meets them.

    rocks : of the layers in the order of `offsets`, [N + 1].
    joints : in the order of `offsets`, [N].
    kind, direction, polarisation : of the pulse, see `axes_of`.
    normal : of the joints, unit vector [d].
    offsets : of the joints from the origin along the normal, ascending, m, [N].
    """
    depths, met = np.asarray(offsets, dtype=float), joints
    if np.asarray(direction) @ normal < 0:
        depths, met, rocks = -depths[::-1], met[::-1], rocks[::-1]
    axes = waves.axes_of(rocks[0], kind, direction, normal, polarisation)
    return PulseStack(axes, rocks, met, depths)
