"""Rock of constant quality factor Q by relaxation mechanisms (generalised Zener body).

Springs in parallel, all but one in series with a dashpot, give the modulus

    M(s) = M_u (1 - sum_l y_l omega_l / (s + omega_l))

with relaxation frequencies omega_l and shares y_l > 0 (Emmerich & Korn, Geophysics 52, 1987;
Blanch, Robertsson & Symes, Geophysics 60, 1995). 1/Q = Im M / Re M at s = i omega is constant in a
band, within a few per cent, if the y_l solve, by non-negative least squares,

    sum_l y_l (omega omega_l + omega_l^2 / Q) / (omega^2 + omega_l^2) = 1/Q .

The scene's modulus gives the phase speed c = sqrt(M / rho) at the reference frequency: M_u is
larger by Re(sqrt(M_u / M))^2.
"""

from functools import lru_cache
from math import ceil, log10, pi
from typing import Any, NamedTuple

import numpy as np

from jointwave.cases.material.calibrate import calibrate

SPACING = 0.85  # most decades between relaxation frequencies: Q is within 4 % from Q = 5 on
BEYOND = 0.1  # decades of relaxation frequencies outside the band at each end
POINTS = 50  # per decade, at which Q is fitted


class Mechanisms(NamedTuple):
    """Relaxation frequencies omega_l [L], rad/s; shares y_l [L] of the unrelaxed modulus; the
    unrelaxed modulus over the given one."""

    frequency: np.ndarray
    share: np.ndarray
    unrelaxed: float

    @property
    def relaxed(self) -> float:
        """The relaxed modulus over the unrelaxed one."""
        return 1 - float(self.share.sum())

    def modulus(self, s: np.ndarray) -> np.ndarray:
        """Return M at Laplace variables s (1/s) over the given modulus."""
        parts = self.share * self.frequency / (np.asarray(s)[..., None] + self.frequency)
        return self.unrelaxed * (1 - parts.sum(axis=-1))


def mechanisms_of(scene: Any, model: str) -> Mechanisms | None:
    """Return the mechanisms of a scene's intact rock, or of a pillar's rock mass for the model
    "equivalent"; None without a quality factor."""
    rock = scene.rock
    if rock.quality_factor is None:
        return None
    found = fitted(rock.quality_factor, *rock.quality_frequencies(scene.pulses))
    if model == "jointed":
        return found
    p = calibrate(scene)
    assert p.intact_modulus is not None
    return in_series(found, p.intact_modulus / p.modulus - 1, p.time_constant or 0.0)


@lru_cache
def fitted(quality: float, reference: float, low: float, high: float) -> Mechanisms:
    """Return the mechanisms of a quality factor from `low` to `high` (Hz); the given modulus sets
    the phase speed at `reference` (Hz)."""
    from scipy.optimize import nnls  # slow to import

    first, last = log10(low) - BEYOND, log10(high) + BEYOND
    frequency = 2 * pi * np.logspace(first, last, 1 + ceil((last - first) / SPACING))
    omega = 2 * pi * np.logspace(log10(low), log10(high), ceil(POINTS * log10(high / low)))[:, None]
    rows = (omega * frequency + frequency**2 / quality) / (omega**2 + frequency**2)
    share, _ = nnls(quality * rows, np.ones(len(omega)))
    found = Mechanisms(frequency[share > 0], share[share > 0], 1.0)
    slowness = 1 / np.sqrt(found.modulus(2j * pi * np.array(reference)))
    return found._replace(unrelaxed=float(slowness.real) ** 2)


def in_series(rock: Mechanisms, ratio: float, eta: float) -> Mechanisms:
    """Return the mechanisms of intact rock and joints in series, relative to their common modulus.

    ratio : compliance of the joints over that of the rock, from given moduli. eta : time constant
    of the joints' dashpots, s.

    Under a strain e the rock's stress is E_u (e - j - sum_l y_l z_l), z_l' = omega_l (e - j - z_l),
    and equals the joints' stress k (j + eta j') at their strain j. In the variables z_l sqrt(y_l /
    omega_l) and j sqrt(k eta / E_u) (for eta = 0, j is eliminated) this is x' = -A x + B e with a
    symmetric A, and the stress E_u (d e - B x): the eigenvalues of A are relaxation frequencies.
    """
    frequency, own = rock.frequency, np.sqrt(rock.share * rock.frequency)
    over = rock.unrelaxed * ratio  # E_u / k
    if eta and ratio:
        at_once, alone = 1.0, np.append(own, 0.0)
        into = np.append(own, np.sqrt(over / eta))
        matrix = np.diag(np.append(frequency, 1 / eta)) + np.outer(into, into)
        matrix = matrix - np.outer(alone, alone)
    else:
        at_once = 1 / (1 + over)
        into = at_once * own
        matrix = np.diag(frequency) - over * at_once * np.outer(own, own)
    relaxes, modes = np.linalg.eigh(matrix)
    weight = (into @ modes) ** 2 / relaxes / at_once
    return Mechanisms(relaxes, weight, at_once * rock.unrelaxed * (1 + ratio))
