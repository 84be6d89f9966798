"""The joints of a set: parallel lines, all through the domain or from joint to joint of others."""

from collections.abc import Sequence
from dataclasses import replace
from math import cos, inf, radians, sin

import numpy as np

from jointwave.cases.partition.lines import Lines
from jointwave.cases.partition.split import split
from jointwave.cases.partition.subdivision import OUTSIDE, PartitionError, Subdivision
from jointwave.cases.schema.joint_set import JointSet
from jointwave.cases.schema.region import REST, Region

#: Of the sets that one ends at, the signed number of the joint below each cell.
Stops = dict[str, np.ndarray]

#: Half the width of the uniform distribution of spacings, in standard deviations.
SPREAD = 3**0.5
#: Cosine and sine of dips, degrees, that are exact.
EXACT = {0.0: (1.0, 0.0), 90.0: (0.0, 1.0), 180.0: (-1.0, 0.0)}


def direction_of(dip: float) -> np.ndarray:
    """Return the unit vector [2] along joints of this dip, degrees from the horizontal."""
    exact = EXACT.get(abs(dip), (cos(radians(dip)), sin(radians(abs(dip)))))
    return np.array([exact[0], exact[1] if dip >= 0 else -exact[1]])


def cut_by_sets(
    sub: Subdivision,
    sets: Sequence[JointSet],
    tolerance: float,
    needed: int | None = None,
    regions: Sequence[Region] = (),
) -> Subdivision:
    """Return a subdivision cut by all joint sets, those that others end at first.

    needed : how many sets, the first ones, must cut something; all where it is absent. regions : of
    the rock, whose cells `sub` tells apart.

    Raises PartitionError where one of them cuts nothing, or a joint lies outside.
    """
    needed = len(sets) if needed is None else needed
    numbers: dict[str, np.ndarray] = {}
    index = {one.name: i for i, one in enumerate(sets)}
    for one in in_order(sets):
        i = index[one.name]
        inside = _inside(sub, one, regions)
        stops = {name: numbers[name] for name in _stops(one, sets)}
        found = split(sub, _lines_of(sub, sets, i, stops, inside, tolerance), tolerance)
        if i < needed and not _has_joints(found.subdivision, i):
            raise PartitionError(
                None, "does not cut the domain, or only where sets before it do", f"joint_sets[{i}]"
            )
        numbers = {name: array[found.parent] for name, array in numbers.items()}
        numbers[one.name] = found.number
        sub = found.subdivision
    return sub


def _inside(sub: Subdivision, one: JointSet, regions: Sequence[Region]) -> np.ndarray:
    """Return which cells are of the rock that a set cuts, bool array [cells]."""
    if not one.regions:
        return np.ones(sub.count, bool)
    names = [*(region.name for region in regions), REST]
    return np.isin(sub.region % len(names), [names.index(name) for name in one.regions])


def _has_joints(sub: Subdivision, index: int) -> bool:
    """Return whether a set is along any edge between cells."""
    own = sub.joint_set[sub.line] == index
    return bool((own & (sub.cells != OUTSIDE).all(axis=1)).any())


def in_order(sets: Sequence[JointSet]) -> list[JointSet]:
    """Return joint sets in the order in which they are cut; raises ValueError, in one phrase, where
    they end at each other."""
    ordered: list[JointSet] = []
    while len(ordered) < len(sets):
        done = {one.name for one in ordered}
        ready = [s for s in sets if s.name not in done and done.issuperset(s.ends_at)]
        if not ready:
            waiting = ", ".join(s.name for s in sets if s.name not in done)
            raise ValueError(f"sets end at each other: {waiting}")
        ordered.append(ready[0])
    return ordered


def widest(one: JointSet) -> float:
    """Return the largest possible distance of two joints of a set, m; infinite for a single one."""
    return inf if one.spacing is None else one.spacing * (1 + SPREAD * one.scatter)


def _stops(one: JointSet, sets: Sequence[JointSet]) -> list[str]:
    """Return the sets that a set ends at, with those at which they end themselves, in order."""
    by_name, found, waiting = {s.name: s for s in sets}, set(), list(one.ends_at)
    while waiting:
        name = waiting.pop()
        if name not in found:
            found.add(name)
            waiting += by_name[name].ends_at
    return [s.name for s in sets if s.name in found]


def _lines_of(
    sub: Subdivision,
    sets: Sequence[JointSet],
    index: int,
    stops: Stops,
    inside: np.ndarray,
    tolerance: float,
) -> Lines:
    """Return the lines of a set in every region between the joints that it ends at.

    stops : of each set that it ends at, the signed number of the joint below each cell. inside :
    which cells it may cut [cells].
    """
    one = sets[index]
    direction = direction_of(one.dip)
    normal = np.array([-direction[1], direction[0]])
    table = np.stack([*stops.values(), np.zeros(sub.count, np.int64)], axis=1)
    regions, family = np.unique(table, axis=0, return_inverse=True)
    family = family.reshape(-1)  # numpy 2.0 gave it another shape
    through = normal @ np.array(one.through if one.through is not None else [0.0, 0.0])
    if one.spacing is None:
        return _single(sub, one, index, direction, through, family, inside, tolerance)
    low, high = _extents(sub, normal, family, len(regions))
    shifts = _shifts(one, normal, stops, regions, sets)
    found = _spaced(one, index, direction, family, regions, through + shifts, low, high)
    return replace(found, family=np.where(inside, family, len(regions)))


def _single(
    sub: Subdivision,
    one: JointSet,
    index: int,
    direction: np.ndarray,
    place: float,
    family: np.ndarray,
    inside: np.ndarray,
    tolerance: float,
) -> Lines:
    """Return one joint, in the region that contains its point."""
    half, at = sub.halves(), np.array(one.through)
    depth = np.full(sub.count, np.inf)
    inward = -((at - sub.points[half.start]) * half.outward).sum(axis=1)
    np.minimum.at(depth, half.cell, inward)
    depth[~inside] = -np.inf
    cell, key = int(np.argmax(depth)), f"joint_sets[{index}].through"
    if depth[cell] < -tolerance:
        of = "its regions" if one.regions else "the domain"
        raise PartitionError(at, f"must lie in {of}", key)
    if len(np.unique(family[depth > -tolerance])) > 1:
        raise PartitionError(at, f"must not lie on a joint of {', '.join(one.ends_at)}", key)
    here = np.where((family == family[cell]) & inside, 0, 1)
    first, base = np.array([0, 1, 1]), np.zeros(2, np.int64)
    return Lines(direction, here, np.array([place]), first, base, index)


def _extents(
    sub: Subdivision, normal: np.ndarray, family: np.ndarray, count: int
) -> tuple[np.ndarray, np.ndarray]:
    """Return from where to where along the normal each family's cells reach, m [count] each."""
    half, s = sub.halves(), sub.points @ normal
    low, high = np.full(count, np.inf), np.full(count, -np.inf)
    np.minimum.at(low, family[half.cell], s[half.start])
    np.maximum.at(high, family[half.cell], s[half.start])
    return low, high


def _shifts(
    one: JointSet, normal: np.ndarray, stops: Stops, regions: np.ndarray, sets: Sequence[JointSet]
) -> np.ndarray:
    """Return by how much joints are offset in each region, m along the normal: by a part of the
    spacing more from each joint that they end at to the next, in the direction of those joints;
    not at all from joints parallel to them, which have no direction across."""
    by_name, shift = {other.name: other for other in sets}, np.zeros(len(regions))
    for k, name in enumerate(stops):
        if name in one.ends_at:
            towards = np.sign(np.round(normal @ direction_of(by_name[name].dip), 12))
            shift += np.mod(towards * one.offset * regions[:, k], 1.0)
    return shift * (one.spacing or 0.0)


def _spaced(
    one: JointSet,
    index: int,
    direction: np.ndarray,
    family: np.ndarray,
    regions: np.ndarray,
    origin: np.ndarray,
    low: np.ndarray,
    high: np.ndarray,
) -> Lines:
    """Return equally spaced or scattered joints that cover every region."""
    assert one.spacing is not None
    if not one.scatter:
        base = np.floor((low - origin) / one.spacing).astype(np.int64)
        count = np.ceil((high - origin) / one.spacing).astype(np.int64) - base + 1
        first = np.append(0, np.cumsum(count))
        which = np.repeat(np.arange(len(regions)), count)
        k = base[which] + np.arange(first[-1]) - first[which]
        places = origin[which] + k * one.spacing
    else:
        each = [_scattered(one, *each) for each in zip(regions, origin, low, high, strict=True)]
        places = np.concatenate([place for place, _ in each])
        base = np.array([number for _, number in each])
        first = np.append(0, np.cumsum([len(place) for place, _ in each]))
    first, base = np.append(first, first[-1]), np.append(base, 0)
    return Lines(direction, family, places, first, base, index)


def _scattered(
    one: JointSet, region: np.ndarray, origin: float, low: float, high: float
) -> tuple[np.ndarray, int]:
    """Return the places of joints from below `low` to above `high`, and the first one's number.

    Spacings are uniformly distributed about their mean; those above and below the origin, and of
    each region, are streams of their own, so that they do not depend on the domain's size.
    """
    above = origin + _spacings(one, region, 0, high - origin)
    below = origin - _spacings(one, region, 1, origin - low)
    return np.concatenate([below[::-1], [origin], above]), -len(below)


def _spacings(one: JointSet, region: np.ndarray, side: int, reach: float) -> np.ndarray:
    """Return the distances of joints from the origin, one beyond the reach at least, m."""
    assert one.spacing is not None and one.seed is not None
    half = SPREAD * one.scatter
    count = max(int(np.ceil(reach / (one.spacing * (1 - half)))), 0) + 1
    folded = [2 * k if k >= 0 else -2 * k - 1 for k in map(int, region)]
    draws = np.random.default_rng([one.seed, side, *folded]).random(count)
    places = np.cumsum(one.spacing * (1 + half * (2 * draws - 1)))
    return places[: np.searchsorted(places, reach) + 1]
