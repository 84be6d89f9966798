"""Slivers: blocks too thin or too pointed, joined to a neighbour or refused."""

import numpy as np

from jointwave.cases.partition.assemble import Rings, rings
from jointwave.cases.partition.convex import union_is_convex
from jointwave.cases.partition.lines import one_line
from jointwave.cases.partition.polygons import least_angles, widths
from jointwave.cases.partition.split import split
from jointwave.cases.partition.subdivision import OUTSIDE, Sliver, Subdivision, joined

#: Cuts of a sliver, at most: parts that made slivers of neighbours could pass round for ever.
PARTS = 4
NO_FIT = ", and joining it to a neighbour leaves no convex block"
Limits = tuple[float, float]  # least width, m, and least angle, degrees


def without_slivers(
    sub: Subdivision, limits: Limits, joins: bool, tolerance: float, kept: int = 0
) -> tuple[Subdivision, Rings]:
    """Return a subdivision without blocks thinner or more pointed than the limits, and its
    outlines.

    joins : each is joined to the neighbour along its longest side with which it is convex, or part
    by part, cut where the sides of neighbours end at it; else, and where nothing fits, it is
    refused. kept : joint sets, the first ones, that a sliver is joined across only where it fits no
    other neighbour. Raises Sliver.
    """
    most = 0
    while True:
        found = rings(sub)
        thin = _slivers(found, limits)
        if not len(thin):
            return sub, found
        most = most or sub.count + PARTS * len(thin)
        if not joins or sub.count > most:
            raise _refusal(found, int(thin[0]), limits, NO_FIT if joins else "")
        sub = _joined_to_neighbours(sub, found, thin, limits, tolerance, kept)


def _slivers(found: Rings, limits: Limits) -> np.ndarray:
    """Return which outlines are slivers, the thinnest first."""
    width, angle = widths(found.corners, found.first), least_angles(found.corners, found.first)
    thin = np.flatnonzero((width < limits[0]) | (angle < limits[1]))
    return thin[np.argsort(width[thin], kind="stable")]


def _joined_to_neighbours(
    sub: Subdivision, found: Rings, thin: np.ndarray, limits: Limits, tolerance: float, kept: int
) -> Subdivision:
    """Return a subdivision with slivers joined, of those that touch only one at a time; where none
    can be, with a part of one of them joined."""
    root, used = np.arange(sub.count), np.zeros(sub.count, bool)
    beside, stuck = _neighbours(sub, found.cell[thin], kept), []
    for one in thin:
        cell = int(found.cell[one])
        near = beside[cell]
        if used[cell] or used[near].any():
            continue
        other = _fitting(found, _corners(found, int(one)), near, tolerance)
        if other is None:
            stuck.append(int(one))
            continue
        root[cell], used[cell] = other, True
        used[near] = True
    if used.any():
        return joined(sub, root)
    slivers = set(found.cell[thin].tolist())
    for one in stuck:
        near = [cell for cell in beside[int(found.cell[one])] if cell not in slivers]
        parted = _parted(sub, found, one, near, tolerance)
        if parted is not None:
            return parted
    raise _refusal(found, stuck[0], limits, NO_FIT)


def _fitting(found: Rings, own: np.ndarray, near: list[int], tolerance: float) -> int | None:
    """Return the first of some cells with which corners [n, 2] make a convex one."""
    for cell in near:
        (other,) = np.flatnonzero(found.cell == cell)
        if union_is_convex(own, _corners(found, int(other)), tolerance):
            return cell
    return None


def _parted(
    sub: Subdivision, found: Rings, one: int, near: list[int], tolerance: float
) -> Subdivision | None:
    """Return a subdivision with a sliver cut along a side of a neighbour that ends at it, and a
    part joined to a neighbour; None where no such cut leaves one that fits."""
    cell, own = int(found.cell[one]), _corners(found, one)
    half = sub.halves(np.isin(sub.cells, near).any(axis=1) & (sub.cells != cell).all(axis=1))
    for start, end in zip(sub.points[half.start], sub.points[half.end], strict=True):
        along = (end - start) / np.hypot(*(end - start))
        s = (own - start) @ [-along[1], along[0]]
        if s.min() > -tolerance or s.max() < tolerance:
            continue
        for sign, part in ((-1, cell), (1, sub.count)):
            other = _fitting(found, _clipped(own, sign * s), near, tolerance)
            if other is not None:
                lines = one_line(along, start, np.arange(sub.count) == cell)
                cut = split(sub, lines, tolerance).subdivision
                root = np.arange(cut.count)
                root[part] = other
                return joined(cut, root)
    return None


def _clipped(corners: np.ndarray, s: np.ndarray) -> np.ndarray:
    """Return the corners of the part of a convex polygon where s, of each corner, is positive."""
    after, ahead = np.roll(corners, -1, axis=0), np.roll(s, -1)
    crosses = s * ahead < 0
    with np.errstate(divide="ignore", invalid="ignore"):
        t = (s / (s - ahead))[crosses, None]
    return np.concatenate([corners[s >= 0], corners[crosses] * (1 - t) + after[crosses] * t])


def _neighbours(sub: Subdivision, cells: np.ndarray, kept: int) -> dict[int, list[int]]:
    """Return the cells beside each of some, that along the longest side first, but those beyond
    joints of the first `kept` sets last."""
    half = sub.halves(np.isin(sub.cells, cells).any(axis=1))
    length = np.hypot(*(sub.points[half.end] - sub.points[half.start]).T)
    of_set = sub.joint_set[sub.line[half.edge]]
    joint = (of_set >= 0) & (of_set < kept)
    beside: dict[int, dict[int, float]] = {int(cell): {} for cell in cells}
    beyond: dict[int, set[int]] = {int(cell): set() for cell in cells}
    for cell, other, part, last in zip(half.cell, half.across, length, joint, strict=True):
        within = other != OUTSIDE and sub.region[cell] == sub.region[other]
        if int(cell) in beside and within:
            shared = beside[int(cell)]
            shared[int(other)] = shared.get(int(other), 0.0) + part
            if last:
                beyond[int(cell)].add(int(other))
    return {
        cell: sorted(shared, key=lambda other: (other in beyond[cell], -shared[other], other))
        for cell, shared in beside.items()
    }


def _corners(found: Rings, one: int) -> np.ndarray:
    return found.corners[found.first[one] : found.first[one + 1]]


def _refusal(found: Rings, one: int, limits: Limits, more: str) -> Sliver:
    own, first = _corners(found, one), np.array([0, found.first[one + 1] - found.first[one]])
    width, angle = float(widths(own, first)[0]), float(least_angles(own, first)[0])
    cause = (
        f"a block is {width:.3g} m wide with an angle of {angle:.3g} degrees, less than "
        f"domain.least_width = {limits[0]:.3g} m or domain.least_angle = {limits[1]:g}{more}"
    )
    return Sliver(own.mean(axis=0), cause)
