"""Joint sets: parallel planes, all through the domain or from joint to joint of other sets."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf

import numpy as np

from jointwave.cases.geometry.cell_complex import Complex, GeometryError
from jointwave.cases.geometry.cut import Planes, cut, planes_of

Stops = dict[str, np.ndarray]  #: of sets that one ends at, the signed number of the joint below

#: Half the width of the uniform distribution of spacings, in standard deviations.
SPREAD = 3**0.5


@dataclass(frozen=True)
class PlaneSet:
    """A set of parallel planes, or one plane, in d dimensions.

    Attributes
    ----------
    name : by which others end at it.
    normal : float array [d], unit vector.
    along : float array [d - 1, d], unit vectors in the plane, by which the sense of an offset along
        it is counted.
    spacing : m, along the normal; None for one plane.
    through : float array [d], m, a point of one of the planes.
    ends_at : names of sets at whose planes these end.
    offset : of the planes from row to row between those that they end at, over the spacing.
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
        """The largest possible distance of two planes, m; infinite for a single one."""
        return inf if self.spacing is None else self.spacing * (1 + SPREAD * self.scatter)


def cut_by_sets(
    body: Complex, sets: Sequence[PlaneSet], tolerance: float, needed: int | None = None
) -> Complex:
    """Return a complex cut by all sets, those that others end at first.

    needed : how many sets, the first ones, must cut something; all where it is absent.

    Raises GeometryError where one of them cuts nothing, or the point of a single joint is outside.
    """
    needed = len(sets) if needed is None else needed
    numbers, ordered = Stops(), in_order(sets)
    index = {one.name: i for i, one in enumerate(sets)}
    for one in ordered:
        i, ends = index[one.name], set(one.ends_at)
        for other in reversed(ordered):  # with those at which they end themselves
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
    """Return sets in the order in which they are cut; raises ValueError, in one phrase, where they
    end at each other."""
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
    """Return the planes of a set in every part of the rock between the joints that it ends at.

    stops : of each set that it ends at the number of each cell.
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
    """Return by how much planes are offset in each part, m along the normal: by a part of the
    spacing more from each joint that they end at to the next, in the sense of the first direction
    in that joint that is not along the planes; not at all from joints parallel to them."""
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
    """Return the places of planes from below `low` to above `high`, m, and the signed number of the
    first.

    Scattered spacings are uniformly distributed about their mean; those above and below the origin,
    and of each part, are streams of their own, so that they do not depend on the domain's size.
    """
    assert one.spacing is not None
    if not one.scatter:
        first = int(np.floor((low - origin) / one.spacing))
        k = np.arange(first, int(np.ceil((high - origin) / one.spacing)) + 1)
        return origin + k * one.spacing, first
    assert one.seed is not None
    half, away = SPREAD * one.scatter, []
    folded = [2 * k if k >= 0 else -2 * k - 1 for k in map(int, part)]
    for side, reach in enumerate((high - origin, origin - low)):  # one beyond it at least
        count = max(int(np.ceil(reach / (one.spacing * (1 - half)))), 0) + 1
        draws = np.random.default_rng([one.seed, side, *folded]).random(count)
        places = np.cumsum(one.spacing * (1 + half * (2 * draws - 1)))
        away.append(places[: np.searchsorted(places, reach) + 1])
    above, below = away
    return np.concatenate([origin - below[::-1], [origin], origin + above]), -len(below)
