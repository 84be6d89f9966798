"""Slivers: blocks too thin or too pointed, joined to a neighbour or refused."""

from __future__ import annotations

import numpy as np

from cases.partition.assemble import Rings, rings
from cases.partition.convex import union_is_convex
from cases.partition.faults import Sliver
from cases.partition.polygons import least_angles, widths
from cases.partition.subdivision import OUTSIDE, Subdivision, joined

Limits = tuple[float, float]  # least width, m, and least angle, degrees


def without_slivers(
    sub: Subdivision, limits: Limits, joins: bool, tolerance: float, kept: int = 0
) -> tuple[Subdivision, Rings]:
    """Return a subdivision without blocks thinner or more pointed than the limits, and its
    outlines.

    joins : each is joined to the neighbour along its longest side with which it is convex; else,
    and where there is none, it is refused. kept : joint sets, the first ones, that a sliver is
    joined across only where it fits no other neighbour. Raises Sliver.
    """
    while True:
        found = rings(sub)
        thin = _slivers(found, limits)
        if not len(thin):
            return sub, found
        if not joins:
            raise _refusal(found, int(thin[0]), limits, "")
        sub = _joined_to_neighbours(sub, found, thin, limits, tolerance, kept)


def _slivers(found: Rings, limits: Limits) -> np.ndarray:
    """Return which outlines are slivers, the thinnest first."""
    width, angle = widths(found.corners, found.first), least_angles(found.corners, found.first)
    thin = np.flatnonzero((width < limits[0]) | (angle < limits[1]))
    return thin[np.argsort(width[thin], kind="stable")]


def _joined_to_neighbours(
    sub: Subdivision, found: Rings, thin: np.ndarray, limits: Limits, tolerance: float, kept: int
) -> Subdivision:
    """Return a subdivision with slivers joined, of those that touch only one at a time."""
    root, used = np.arange(sub.count), np.zeros(sub.count, bool)
    place = np.full(sub.count, -1)
    place[found.cell] = np.arange(len(found.cell))
    beside = _neighbours(sub, found.cell[thin], kept)
    for one in thin:
        cell, own = int(found.cell[one]), _corners(found, int(one))
        near = beside[cell]
        fits = (
            other
            for other in near
            if union_is_convex(own, _corners(found, int(place[other])), tolerance)
        )
        if used[cell] or used[near].any():
            continue
        other = next(fits, None)
        if other is None:
            raise _refusal(found, int(one), limits, ", and is convex with none of its neighbours")
        root[cell], used[cell] = other, True
        used[near] = True
    return joined(sub, root)


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
        if int(cell) in beside and other != OUTSIDE:
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
