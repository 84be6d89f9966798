"""Plane P, SV and SH waves in isotropic rock, incident on a plane face or joint.

Factor e^{-i omega t}; stress tension positive. The face has the axes t along it and n across it; p
is the slowness along t that all waves share (Aki & Richards, Quantitative Seismology, 2002, chapter
5). With the sines a' = a p, s = b p and the cosines c = sqrt(1 - a'^2), k = sqrt(1 - s^2), waves
along +n and -n have the polarisations (t, n)

    P+- = (a', +-c),   SV+ = (k, -s),   SV- = (k, s)

so that a wave and its mirror image have the same amplitude. The SV+ polarisation is its direction
of travel rotated by a right angle from n to t. SH waves move along b, normal to t and n. Beyond the
critical angle c is imaginary, +i |c|: for Re(omega) > 0 the P wave decays away from the face. For
negative frequencies take complex conjugates.
"""

from typing import Literal, NamedTuple

import numpy as np

from jointwave.cases.material.rock import ElasticRock, Values

Kind = Literal["P", "SV", "SH"]
#: Kinds of waves that a face converts into each other: in the plane of incidence, and normal to it.
KINDS: tuple[Kind, ...] = ("P", "SV")
ACROSS: tuple[Kind, ...] = ("SH",)
STRAIGHT = 1e-6  #: sine of the largest angle from the normal that counts as normal incidence


class Face(NamedTuple):
    """Tractions and velocities on a face under unit waves (m/s) along +n: complex [..., kinds]. For
    waves along -n, `shear` and `normal_velocity` change sign."""

    normal: np.ndarray  # sigma_nn, Pa
    shear: np.ndarray  # sigma_tn, for SH sigma_bn, Pa
    normal_velocity: np.ndarray
    shear_velocity: np.ndarray


class PlaneMotion(NamedTuple):
    """Displacement (m), velocity (m/s) and stress (Pa, as in `WaveMotion`) at m places, arrays [m,
    components, times], and error bounds [m, components]."""

    displacement: np.ndarray
    velocity: np.ndarray
    stress: np.ndarray
    displacement_error: np.ndarray
    velocity_error: np.ndarray
    stress_error: np.ndarray


def kinds_with(kind: Kind) -> tuple[Kind, ...]:
    """Return the kinds of waves into which a face converts a kind, itself included."""
    return KINDS if kind in KINDS else ACROSS


def speed_of(rock: ElasticRock, kind: Kind) -> Values:
    """Return the speed of a kind of wave, m/s."""
    return rock.p_speed if kind == "P" else rock.s_speed


def slowness_along(rock: ElasticRock, kind: Kind, angle: Values) -> np.ndarray:
    """Return p (s/m) of a wave at `angle` from n towards t, rad, below a right angle."""
    return np.sin(angle) / np.asarray(speed_of(rock, kind))


class Axes(NamedTuple):
    """Axes of the joints: rows t, n and, in space, b in scene coordinates [d, d], n in the sense of
    travel; slowness p along t (s/m); kind of the incident wave, and its amplitudes for all
    `kinds`."""

    rows: np.ndarray
    slowness: float
    kind: Kind
    incident: np.ndarray

    @property
    def kinds(self) -> tuple[Kind, ...]:
        """The kinds of waves that occur."""
        return kinds_with(self.kind)


def axes_of(
    rock: ElasticRock,
    kind: Kind,
    direction: np.ndarray,
    normal: np.ndarray,
    polarisation: np.ndarray | None = None,
) -> Axes:
    """Return the axes of joints with a unit normal [d] for waves with a direction [d] that is not
    along the joints.

    polarisation : of an S wave in space [3]; the part along the given kind's motion is incident.
    """
    direction = np.asarray(direction) / np.linalg.norm(direction)
    n = np.asarray(normal) * (1.0 if direction @ normal > 0 else -1.0)
    share = 1.0
    if len(n) == 2:
        rows = np.array([[-n[1], n[0]], n])
    else:
        t = direction - (direction @ n) * n
        if np.linalg.norm(t) < STRAIGHT:
            free = kind == "P" or polarisation is None
            t = np.eye(3)[np.abs(n).argmin()] if free else np.asarray(polarisation)
            t = t - (t @ n) * n
        t = t / np.linalg.norm(t)
        rows = np.array([t, n, np.cross(t, n)])
        if polarisation is not None and kind != "P":
            moved = rows[2] if kind == "SH" else (direction @ n) * t - (direction @ t) * n
            share = float(moved @ polarisation)
    slowness, kinds = direction @ rows[0] / speed_of(rock, kind), kinds_with(kind)
    return Axes(rows, float(slowness), kind, share * np.eye(len(kinds))[kinds.index(kind)])


def cosines(rock: ElasticRock, slowness: Values) -> tuple[np.ndarray, np.ndarray]:
    """Return the complex cosines c and k; slowness p in s/m."""
    sines = np.asarray(rock.p_speed * slowness), np.asarray(rock.s_speed * slowness)
    c, k = (np.sqrt((1 - x) * (1 + x) + 0j) for x in sines)
    return c, k


def is_evanescent(rock: ElasticRock, slowness: float) -> bool:
    """Return whether P waves of slowness p (s/m) decay away from the face."""
    return bool(np.abs(rock.p_speed * slowness) > 1)


def slownesses_across(
    rock: ElasticRock, slowness: Values, kinds: tuple[Kind, ...] = KINDS
) -> np.ndarray:
    """Return c/a for P and k/b for S (s/m), complex array [..., kinds]."""
    c, k = cosines(rock, slowness)
    found = np.stack(np.broadcast_arrays(c / rock.p_speed, k / rock.s_speed), axis=-1)
    return found if kinds == KINDS else found[..., 1:]


def face(rock: ElasticRock, slowness: Values, kinds: tuple[Kind, ...] = KINDS) -> Face:
    """Return tractions and velocities of unit waves along +n with slowness p (s/m) on a face."""
    c, k = cosines(rock, slowness)
    a, s = rock.p_speed * slowness, rock.s_speed * slowness
    if kinds == ACROSS:
        still = 0 * k[..., None]
        shear = -np.multiply(rock.s_impedance, k)[..., None]
        return Face(still, shear, still, still + 1)
    double = 1 - 2 * s * s  # cos 2 phi
    pairs = (
        (-rock.p_impedance * double, 2 * rock.s_impedance * s * k),
        (-2 * rock.s_impedance * s * c, -rock.s_impedance * double),
        (c, -s),
        (a, k),
    )
    return Face(*(np.stack(np.broadcast_arrays(p, sv), axis=-1) + 0j for p, sv in pairs))


def polarisations(rock: ElasticRock, slowness: float) -> np.ndarray:
    """Return the polarisations of P and SV along +n and along -n, complex array [2, 2, (t, n)]."""
    c, k = cosines(rock, slowness)
    a, s = rock.p_speed * slowness, rock.s_speed * slowness
    return np.array([[[a, c], [k, -s]], [[a, -c], [k, s]]])


def stress(rock: ElasticRock, slowness: np.ndarray, polarisation: np.ndarray) -> np.ndarray:
    """Return the stress of unit plane waves (1 m/s) in any axes, Pa, array [..., d, d].

    slowness, polarisation : arrays [..., d], s/m and 1. The velocity is g f(t - s.x), the stress
    -(lambda (s.g) I + mu (s g + g s)) f.
    """
    sg = slowness[..., :, None] * polarisation[..., None, :]
    trace = np.trace(sg, axis1=-2, axis2=-1)[..., None, None]
    sheared = rock.shear_modulus * (sg + np.swapaxes(sg, -2, -1))
    return -(rock.lame * trace * np.eye(sg.shape[-1]) + sheared)
