"""Place and time at which a pulse first breaks a bar with a free end, and the chain.

At the distance x from the free end a pulse f, which entered the start at t = 0, and its reflection
add up to the tension (Kolsky, Stress Waves in Solids, 1953)

    g = f(a) - f(b),   a = t - (L + x)/c,   b = t - (L - x)/c

The first failure is the least a + b under g >= sigma_t and 0 <= b - a <= 2 L/c. On each pair of
pieces of a piecewise linear f that is a linear program of two variables, solved by its vertices.
A smooth f is taken as a polygon, which is refined around what was found until its error, of second
order in its pieces, is at round-off. A saw tooth of length lam breaks at x = lam sigma_t / (2 p0).

Holds until the reflection is back at the start.
"""

from itertools import combinations
from math import ceil
from typing import NamedTuple

import numpy as np

from jointwave.cases.histories import LoadHistory, Recorded, Step
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.sampling import sample_times
from jointwave.cases.schema.scene import Scene
from jointwave.compare.exact.blocks.pillar import system_of
from jointwave.compare.exact.blocks.row_of_blocks import contact_forces
from jointwave.compare.exact.conditions import drive
from jointwave.compare.exact.linear import _load_on_nodes, gauss, twins

PIECES = 400  # of a polygon
REFINEMENTS = 2  # each by PIECES / 4


class Spall(NamedTuple):
    """Where and when tension first reaches the strength.

    distance : from the free end, m. time : since the pulse entered at the start, s.
    """

    distance: float
    time: float


class SpallPieces(NamedTuple):
    """Straight pieces of a history: from `start` to `end` (s), from `left` to `right` (Pa)."""

    start: np.ndarray
    end: np.ndarray
    left: np.ndarray
    right: np.ndarray


def spall(
    load: LoadHistory, strength: float, length: float, speed: float, duration: float
) -> Spall | None:
    """Return the first failure in tension of a homogenised bar, None where there is none.

    Parameters
    ----------
    load : the end stress, Pa, compression positive; of one that is not recorded, up to `duration`.
    strength : tensile strength, Pa.
    length, speed : of the bar, m and m/s.
    """
    longest = 2 * length / speed
    if isinstance(load, Recorded):
        pieces = _pieces(load.time, load.stress, longest)
        found = first_pair(pieces, pieces, strength, longest)
    elif isinstance(load, Step):
        p = load.amplitude
        pieces = SpallPieces(*np.array([[-longest, 0.0], [0.0, duration], [0.0, p], [0.0, p]]))
        found = first_pair(pieces, pieces, strength, longest)
    else:
        found = _of_smooth(load, strength, longest, duration)
    if found is None:
        return None
    a, b = found
    return Spall(speed * (b - a) / 2, (a + b) / 2 + length / speed)


def _of_smooth(load, strength: float, longest: float, duration: float):
    """Return `first_pair` of a history that is smooth between its breaks."""

    def polygon(around: float, width: float) -> SpallPieces:
        t = np.union1d(np.linspace(around - width, around + width, PIECES + 1), load.breaks)
        t = t[np.abs(t - around) <= width]
        return _pieces(t, load.value(t), 0.0)

    width = (duration + longest) / 2
    whole = polygon(duration - width, width)
    found = first_pair(whole, whole, strength, longest)
    for _ in range(REFINEMENTS):
        if found is not None:
            width *= 4 / PIECES
            a, b = found
            finer = first_pair(polygon(a, width), polygon(b, width), strength, longest)
            found = finer or found
    return found


def _pieces(time: np.ndarray, stress: np.ndarray, silence: float) -> SpallPieces:
    """Return a history's pieces, with silence (s) before and behind it."""
    start, end, left, right = time[:-1], time[1:], stress[:-1], stress[1:]
    if silence:
        start = np.concatenate([[time[0] - silence], start, [time[-1]]])
        end = np.concatenate([[time[0]], end, [time[-1] + silence]])
        left, right = np.pad(left, 1), np.pad(right, 1)
    return SpallPieces(start, end, left, right)


def first_pair(
    ahead: SpallPieces, behind: SpallPieces, strength: float, longest: float
) -> tuple[float, float] | None:
    """Return a and b (s) of the least a + b with f(a) - f(b) >= strength, 0 <= b - a <= longest.

    a lies on a piece of the one, b on a piece of the other that does not end before.
    """
    A, B = (
        SpallPieces(*(x[i] for x in p)) for p, i in ((ahead, np.s_[:, None]), (behind, np.s_[None]))
    )
    rise, fall = ((p.right - p.left) / (p.end - p.start) / strength for p in (A, B))
    level = 1 - (A.left - B.left) / strength + rise * A.start - fall * B.start
    # Each side of a pair's feasible polygon as p a + q b = r.
    sides: list[tuple] = [(1, 0, A.start), (1, 0, A.end), (0, 1, B.start), (0, 1, B.end)]
    sides += [(1, -1, 0.0), (1, -1, -longest), (rise, -fall, level)]
    slack, best, least = 1e-12 * longest, None, np.inf
    for one, other in combinations(sides, 2):
        a, b = np.broadcast_arrays(*_crossing(*one, *other), A.start + B.start)[:2]
        inside = (a >= A.start - slack) & (a <= A.end + slack) & (B.end > A.start)
        inside &= (b >= B.start - slack) & (b <= B.end + slack)
        inside &= (b >= a - slack) & (b - a <= longest + slack)
        inside &= rise * a - fall * b >= level - 1e-9
        total = np.where(inside, a + b, np.inf)
        i = np.unravel_index(np.argmin(total), total.shape)
        if total[i] < least:
            least, best = total[i], (float(a[i]), float(b[i]))
    return best


def _crossing(p, q, r, P, Q, R) -> tuple[np.ndarray, np.ndarray]:
    """Return where p a + q b = r and P a + Q b = R meet; not a number where they do not."""
    det = np.asarray(p * Q - q * P, dtype=float)
    det = np.where(det == 0, np.nan, det)
    return (r * Q - q * R) / det, (p * R - r * P) / det


def advance(
    matrix: np.ndarray,
    vector: np.ndarray,
    state: np.ndarray,
    load: LoadHistory,
    start: float,
    h: float,
) -> np.ndarray:
    """Return the state [m] that `state` at `start` (s) becomes a time h (s) later."""
    from scipy.sparse import csr_array
    from scipy.sparse.linalg import expm_multiply

    A = csr_array(matrix)
    nodes, weights = gauss(h, 12 + ceil(h * abs(A).sum(axis=0).max()))
    share = _load_on_nodes(load, np.array([start]), h, nodes, weights)[0]
    G = np.stack([expm_multiply(A * (h - s), vector) for s in nodes], axis=1)
    return expm_multiply(A * h, state) + G @ share


def lattice_spall(scene: Scene) -> Spall | None:
    """Return the first failure of the scene's rigid-block chain, at one of its joints.

    The chain is linear until then, so its exact solution holds; gravity, if any, is static.
    """
    p, model, times = calibrate(scene), system_of(scene), sample_times(scene)
    strength = p.tensile_strength
    if strength is None:
        raise ValueError("no joint has a tensile strength")
    signal, matrix, vector = drive(scene), model.matrix, model.load
    states = twins(matrix, vector, signal, times)[0]

    def excess(moved: np.ndarray) -> np.ndarray:
        joints = contact_forces(model, moved)[..., 1 : scene.block_count]
        return -joints / p.area - strength

    broken = (excess(states) >= 0).any(axis=1)
    if not broken.any():
        return None
    last = int(np.argmax(broken)) - 1
    if last < 0:
        return Spall(scene.pillar.length - p.joint_y[np.argmax(excess(states[0]))], 0.0)
    from scipy.optimize import brentq

    def later(h: float) -> np.ndarray:
        return excess(advance(matrix, vector, states[last], signal, times[last], h))

    h = brentq(lambda h: float(later(h).max()), 1e-9 * scene.interval, scene.interval)
    y = p.joint_y[np.argmax(later(h))]
    return Spall(float(scene.pillar.length - y), float(times[last] + h))
