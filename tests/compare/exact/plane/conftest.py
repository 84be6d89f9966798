"""Shared by several tests of waves in jointed rock in plane strain."""

from typing import NamedTuple

import numpy as np
import pytest

from jointwave.cases.material.rock import ElasticRock
from jointwave.compare.exact.plane.oblique_joint import Joint


class Referee(NamedTuple):
    """Rock and parallel joints as one linear system of boundary conditions, in plain numbers.

    rock : density, speeds, of all layers or of each. joints : rows K_n, K_s, eta_n, eta_s.
    spacings : between them.
    """

    rock: tuple[float, float, float] | list[tuple[float, float, float]]
    joints: list[tuple[float, float, float, float]]
    spacings: list[float]

    def wave(self, layer, kind, slowness, way):
        """Return slowness [2], polarisation [2] and the stresses sigma_nn, sigma_tn of 1 m/s."""
        density, a, b = self.rock[layer] if isinstance(self.rock, list) else self.rock
        lame, mu = density * (a**2 - 2 * b**2), density * b**2
        speed = a if kind == "P" else b
        s = np.array([slowness, way * np.sqrt(1 / speed**2 - slowness**2 + 0j)])
        g = s * speed if kind == "P" else way * np.array([s[1], -s[0]]) * speed
        exx, ezz, gxz = -s[0] * g[0], -s[1] * g[1], -s[0] * g[1] - s[1] * g[0]
        return s, g, np.array([(lame + 2 * mu) * ezz + lame * exx, mu * gxz])

    def solve(self, incidence, slowness, omega):
        """Return R_p, R_s, T_p, T_s from 4 N equations for 4 N amplitudes."""
        count = len(self.joints)
        z = np.concatenate([[0.0], np.cumsum(self.spacings)])
        waves = [(0, kind, -1, z[0]) for kind in ("P", "SV")]
        for layer in range(1, count):
            waves += [(layer, kind, 1, z[layer - 1]) for kind in ("P", "SV")]
            waves += [(layer, kind, -1, z[layer]) for kind in ("P", "SV")]
        waves += [(count, kind, 1, z[-1]) for kind in ("P", "SV")]
        matrix = np.zeros((4 * count, 4 * count + 1), dtype=complex)
        for column, (layer, kind, way, start) in enumerate([*waves, (0, incidence, 1, z[0])]):
            s, g, traction = self.wave(layer, kind, slowness, way)
            for j, (K_n, K_s, eta_n, eta_s) in enumerate(self.joints):
                if layer not in (j, j + 1):
                    continue
                side = 1 if layer == j + 1 else -1
                phase = np.exp(1j * omega * s[1] * (z[j] - start))
                jump = side * g[::-1] / (-1j * omega)
                K = np.array([K_n - 1j * omega * eta_n, K_s - 1j * omega * eta_s])
                matrix[4 * j : 4 * j + 2, column] += side * traction * phase
                behind = traction / K if side > 0 else 0
                matrix[4 * j + 2 : 4 * j + 4, column] += (jump - behind) * phase
        scale = np.abs(matrix).max(axis=1, keepdims=True)
        found = np.linalg.solve((matrix / scale)[:, :-1], -(matrix / scale)[:, -1])
        return np.concatenate([found[:2], found[-2:]])


@pytest.fixture
def referee():
    """Return the system of boundary conditions of parallel joints."""
    return Referee


@pytest.fixture
def rock():
    """Return rock of nu = 0.25."""
    return ElasticRock(2600.0, 3000.0 * np.sqrt(3.0), 3000.0)


@pytest.fixture
def joint(rock):
    """Return the joint K_n = Z_p omega, K_s = Z_s omega at 100 Hz."""
    omega = 2 * np.pi * 100.0
    return Joint(rock.p_impedance * omega, rock.s_impedance * omega)


@pytest.fixture
def ricker():
    """Return a Ricker pulse of 100 Hz and 1 m/s, round-off before 0 s."""

    def velocity(t):
        x = (100 * np.pi * (t - 0.021)) ** 2
        return (1 - 2 * x) * np.exp(-x)

    return velocity


@pytest.fixture
def directed():
    """Return the direction of travel at an angle (degrees) from y towards x."""
    return lambda degrees: np.array([np.sin(np.radians(degrees)), np.cos(np.radians(degrees))])
