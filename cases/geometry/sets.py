"""Joint sets as parallel planes, through the whole domain or between joints of other sets."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf

import numpy as np

from jointwave.cases.geometry.cell_complex import Complex, GeometryError
from jointwave.cases.geometry.cut import Planes, cut, planes_of

Stops = dict[str, np.ndarray]  #: for sets that another ends at, each cell's joint number below

#: Half the width of the uniform distribution of spacings, in standard deviations.
SPREAD = 3**0.5


@dataclass(frozen=True)
class PlaneSet:
    """A set of parallel planes, or one plane, in d dimensions.

    name : that other sets refer to.
    normal : float array [d], unit vector.
    along : float array [d - 1, d], unit vectors in the plane, which define the sense of offsets.
    spacing : m, along the normal; None for one plane.
    through : float array [d], m, a point of one of the planes.
    ends_at : names of sets at whose planes these end.
    offset : of the planes between neighbouring rows bounded by `ends_at`, over the spacing.
    scatter : coefficient of variation of the spacing, uniformly distributed. seed : of the scatter.
    regions : indices of the regions of rock that it cuts, -1 for rock in none; None for all.
    """

    name: str
    normal: np.ndarray
    along: np.ndarray
    spacing: float | None
    through: np.ndarray
    ends_at: tuple[str, ...] = ()
    offset: float = 0.0
    scatter: float = 0.0
    seed: int | None = None
    regions: tuple[int, ...] | None = None

    @property
    def widest(self) -> float:
        """Largest possible distance between neighbouring planes, m; infinite for a single one."""
        return inf if self.spacing is None else self.spacing * (1 + SPREAD * self.scatter)


def cut_by_sets(
    body: Complex, sets: Sequence[PlaneSet], tolerance: float, needed: int | None = None
) -> Complex:
    """Return a complex cut by all sets, those that others end at first.

    needed : number of leading sets that must cut something; all where absent. Raises GeometryError
    if one of them does not, or if the point of a single joint is outside.
    """
    needed = len(sets) if needed is None else needed
    numbers, ordered = Stops(), in_order(sets)
    index = {one.name: i for i, one in enumerate(sets)}
    for one in ordered:
        i, ends = index[one.name], set(one.ends_at)
        for other in reversed(ordered):  # and the sets at which those end
            ends.update(other.ends_at if other.name in ends else ())
        stops = {name: numbers[name] for name in index if name in ends}
        found = cut(body, _planes(body, sets, i, stops, tolerance), tolerance)
        if i < needed and not (found.body.inner & (found.body.joint_set == i)).any():
            cause = "does not cut the domain, or only where sets before it do"
            raise GeometryError(None, cause, f"joint_sets[{i}]")
        numbers = {name: array[found.parent] for name, array in numbers.items()}
        numbers[one.name] = found.number
        body = found.body
    return body


def in_order(sets: Sequence[PlaneSet]) -> list[PlaneSet]:
    """Return sets in the order in which they are cut. Raises ValueError, in one phrase, if they end
    at each other."""
    ordered: list[PlaneSet] = []
    while len(ordered) < len(sets):
        done = {one.name for one in ordered}
        ready = [s for s in sets if s.name not in done and done.issuperset(s.ends_at)]
        if not ready:
            waiting = ", ".join(s.name for s in sets if s.name not in done)
            raise ValueError(f"sets end at each other: {waiting}")
        ordered.append(ready[0])
    return ordered


def _planes(
    body: Complex, sets: Sequence[PlaneSet], index: int, stops: Stops, tolerance: float
) -> Planes:
    """Return the planes of a set in each part of the rock between the joints at which it ends.

    stops : for each of these sets, the joint number of each cell.
    """
    one = sets[index]
    table = np.stack([*stops.values(), np.zeros(body.count, np.int64)], axis=1)
    parts, family = np.unique(table, axis=0, return_inverse=True)
    family = family.reshape(-1)  # numpy 2.0 gave it another shape
    inside = np.ones(body.count, bool)
    if one.regions is not None:
        inside = np.isin(body.region, one.regions)
    if one.spacing is None:
        key, depth = f"joint_sets[{index}].through", body.depths(one.through)
        depth = np.where(inside, depth, -np.inf)
        cell = int(np.argmax(depth))  # in the part of the rock that contains the point
        if depth[cell] < -tolerance:
            of = "the domain" if one.regions is None else "its regions"
            raise GeometryError(one.through, f"must lie in {of}", key)
        if len(np.unique(family[depth > -tolerance])) > 1:
            cause = f"must not lie on a joint of {', '.join(one.ends_at)}"
            raise GeometryError(one.through, cause, key)
        single = np.where(inside & (family == family[cell]), 0, -1)
        return planes_of(one.normal, single, [np.array([one.normal @ one.through])], None, index)
    low, high = np.full(len(parts), np.inf), np.full(len(parts), -np.inf)
    least, most = body.extents(body.halves(), body.vertices @ one.normal)
    np.minimum.at(low, family, least)
    np.maximum.at(high, family, most)
    origin = one.normal @ one.through + _shifts(one, stops, parts, sets)
    each = [places_between(one, *part) for part in zip(parts, origin, low, high, strict=True)]
    places, base = zip(*each, strict=True)
    return planes_of(one.normal, np.where(inside, family, -1), places, base, index, tolerance)


def _shifts(one: PlaneSet, stops: Stops, parts: np.ndarray, sets: Sequence[PlaneSet]) -> np.ndarray:
    """Return the offset of the planes in each part, m along the normal. From each joint at which
    they end to the next it grows by a share of the spacing, in the sense of the first direction in
    that joint that is not parallel to the planes."""
    by_name, shift = {other.name: other for other in sets}, np.zeros(len(parts))
    for k, name in enumerate(stops):
        if name in one.ends_at:
            towards = np.sign(np.round(by_name[name].along @ one.normal, 12))
            sense = next((sign for sign in towards if sign), 0.0)
            shift += np.mod(sense * one.offset * parts[:, k], 1.0)
    return shift * (one.spacing or 0.0)


def places_between(
    one: PlaneSet, part: np.ndarray, origin: float, low: float, high: float
) -> tuple[np.ndarray, int]:
    """Return the places of planes from below `low` to above `high`, m, and the number of the first.

    Scattered spacings are uniformly distributed about their mean. Each part, above and below its
    origin, has its own random stream, so that places do not depend on the domain's size.
    """
    assert one.spacing is not None
    if not one.scatter:
        first = int(np.floor((low - origin) / one.spacing))
        k = np.arange(first, int(np.ceil((high - origin) / one.spacing)) + 1)
        return origin + k * one.spacing, first
    assert one.seed is not None
    half, away = SPREAD * one.scatter, []
    folded = [2 * k if k >= 0 else -2 * k - 1 for k in map(int, part)]
    for side, reach in enumerate((high - origin, origin - low)):  # to one plane past the reach
        count = max(int(np.ceil(reach / (one.spacing * (1 - half)))), 0) + 1
        draws = np.random.default_rng([one.seed, side, *folded]).random(count)
        places = np.cumsum(one.spacing * (1 + half * (2 * draws - 1)))
        away.append(places[: np.searchsorted(places, reach) + 1])
    above, below = away
    return np.concatenate([origin - below[::-1], [origin], origin + above]), -len(below)
