"""Merging of convex cells: pieces of one block, or slivers that are too thin or too pointed."""

from collections.abc import Iterable, Sequence
from math import inf

import numpy as np

from jointwave.cases.geometry.cell_complex import Complex, Sliver
from jointwave.cases.geometry.cut import cut, one_plane
from jointwave.cases.geometry.measure import cell_moments, facet_moments, least_angles, widths
from jointwave.cases.geometry.relations import groups

LAYER = 5.0  # largest thickness of a layer over volume per surface: 2 if thin, 4 for a square
ALONG = 0.9998  # cosine of the angle, 1.1 degrees, within which faces are almost parallel
BESIDE = (
    "a parallel joint or boundary of a region, less than domain.least_width, or at an angle below "
    "domain.least_angle: put both in one plane, or set these below that"
)


class Pieces:
    """Cells of a complex that are to be merged; one of its cells gives each piece its number.

    root : int array [count], the piece that each cell belongs to.
    thickness : volume over surface of each cell, m, by cell number.
    """

    def __init__(
        self, body: Complex, cells: np.ndarray, across: np.ndarray, kept: float = inf
    ) -> None:
        """Set up cells (bool [count]) that merge across some facets (bool [f]); kept : number of
        leading joint sets across which they merge only as a last choice; infinite: all alike."""
        self.body, self.root, self.half = body, np.arange(body.count), body.beside(cells)
        moments, self._place = facet_moments(body, self.half.facet), body.places(self.half)
        corners, self._area = body.corners(self.half), moments.size
        self._open = across[self.half.facet]
        joint_set = body.joint_set[self.half.facet]
        self._jointed = (joint_set >= 0) & (joint_set < kept)
        self._joint = self._jointed & (kept < inf)
        volume = cell_moments(body, self.half, moments).size
        self._halves = {int(self.half.cell[own[0]]): own for own in groups(self.half.cell)}
        self._vertices = {int(corners[own[0], 0]): corners[own, 1] for own in groups(corners[:, 0])}
        self.thickness = {
            cell: float(volume[cell] / self._area[own].sum()) for cell, own in self._halves.items()
        }

    def near(self, piece: int) -> list[int]:
        """Return the pieces to merge with, by decreasing shared area, across kept joints last."""
        own = self._halves[piece][self._open[self._halves[piece]]]
        beside, which = np.unique(self.root[self.half.across[own]], return_inverse=True)
        area = np.bincount(which, self._area[own])
        joint = np.bincount(which, self._joint[own]) > 0
        return beside[np.lexsort([beside, -area, joint])].tolist()

    def fitting(self, piece: int, near: Iterable[int], tolerance: float) -> int | None:
        """Return the first candidate whose union with a piece is convex, or None."""
        for other in near:
            both = np.append(self._halves[piece], self._halves[other])
            across = self.half.across[both]
            outer = both[(across < 0) | ~np.isin(self.root[across], [piece, other])]
            corners = np.append(self._vertices[piece], self._vertices[other])
            heights = self.body.vertices[corners] @ self.half.outward[outer].T
            if (heights <= self._place[outer] + tolerance).all():
                self._check_layer(piece, other)
                return other
        return None

    def _check_layer(self, piece: int, other: int) -> None:
        """Raise Sliver if a thin piece that merges across a joint has a joint or a weld of regions
        on its other side: rock would lose one of both."""
        own = self._halves[piece]
        across = self.half.across[own]
        between = own[self._jointed[own] & (self.root[across] == other)]
        facing = own[(across >= 0) & (self._jointed[own] | ~self._open[own])]
        place = self.body.vertices[self._vertices[piece]].mean(axis=0)
        away = self._place - self.half.outward @ place
        apart = np.add.outer(away[facing], away[between])
        opposed = self.half.outward[facing] @ self.half.outward[between].T < -ALONG
        if (opposed & (apart < LAYER * self.thickness[piece])).any():
            raise Sliver(place, f"a joint is {apart[opposed].min():.3g} m from {BESIDE}")

    def joined(self, order: Iterable[int], tolerance: float) -> tuple[Complex | None, list[int]]:
        """Merge cells, in order, with their first convex neighbour. Return the complex, or None if
        nothing merged; and the cells without a convex neighbour."""
        stuck = list[int]()
        for cell in order:
            if self.root[cell] != cell:
                continue
            other = self.fitting(cell, self.near(cell), tolerance)
            if other is None:
                stuck.append(cell)
                continue
            self.root[self.root == other] = cell
            for table in (self._halves, self._vertices):
                table[cell] = np.append(table[cell], table.pop(other))
        changed = (self.root != np.arange(len(self.root))).any()
        return self.body.joined(self.root) if changed else None, stuck


def clipped(corners: np.ndarray, s: np.ndarray) -> np.ndarray:
    """Return the corners of the part of a convex polygon or segment with s >= 0 at its corners."""
    after, ahead = np.roll(corners, -1, axis=0), np.roll(s, -1)
    crosses = s * ahead < 0
    if len(corners) == 2:
        crosses[1] = False  # a segment is open: no edge from its end to its start
    t = np.where(crosses, s / np.where(crosses, s - ahead, 1.0), 0.0)[:, None]
    pairs = np.stack([corners, corners + t * (after - corners)], axis=1)
    return pairs.reshape(-1, corners.shape[1])[np.stack([s >= 0, crosses], axis=1).ravel()]


#: Most cuts per sliver: merging parts could otherwise turn neighbours into slivers for ever.
PARTS = 4
NO_FIT = ", and joining it to a neighbour leaves no convex block"


def without_slivers(
    body: Complex,
    least_width: float,
    least_angle: float,
    joins: bool,
    tolerance: float,
    kept: float = inf,
) -> Complex:
    """Return a complex without blocks thinner (m) or more pointed (degrees) than the limits.

    joins : merge each sliver with the neighbour across its largest face that makes a convex union,
    or cut it along a neighbour's face and merge part by part. kept : number of leading joint sets
    that slivers merge across only as a last choice. Raises Sliver for slivers that are left.
    """
    most = 0
    while True:
        half = body.halves()
        width, angle = widths(body, half), least_angles(body, half)
        thin = np.flatnonzero((width < least_width) | (angle < least_angle))
        if not len(thin):
            return body
        thin = thin[np.argsort(width[thin], kind="stable")]
        most = most or body.count + PARTS * len(thin)
        found, wrong = None, int(thin[0])
        if joins and body.count <= most:
            found, wrong = _joined(body, thin.tolist(), tolerance, kept)
        if found is None:
            cause = (
                f"a block is {width[wrong]:.3g} m wide with an angle of {angle[wrong]:.3g} degrees,"
                f" less than domain.least_width = {least_width:.3g} m or domain.least_angle = "
                f"{least_angle:g}{NO_FIT if joins else ''}"
            )
            raise Sliver(body.centres(half)[wrong], cause)
        body = found


def _joined(
    body: Complex, thin: list[int], tolerance: float, kept: float
) -> tuple[Complex | None, int]:
    """Merge slivers with neighbours, or, if none can be, a part of one of them. Return the complex,
    or None if no part can be merged; and the first sliver that fits nowhere."""
    chosen = np.zeros(body.count + 1, bool)
    chosen[thin] = True
    chosen[body.sides[chosen[body.sides].any(axis=1)].ravel()] = True
    pieces = Pieces(body, chosen[:-1], body.in_rock, kept)
    found, stuck = pieces.joined(thin, tolerance)
    for cell in stuck if found is None else ():
        near = [other for other in pieces.near(cell) if other not in thin]
        if (found := _split(body, cell, near, tolerance, kept)) is not None:
            break
    return found, (stuck or thin)[0]


def _split(
    body: Complex, cell: int, near: Sequence[int], tolerance: float, kept: float
) -> Complex | None:
    """Return a complex with a sliver cut along a neighbour's face and one part merged with a
    neighbour, or None if no such cut leaves a part that fits."""
    alone, chosen = np.arange(body.count) == cell, np.isin(np.arange(body.count + 1), near)
    half = body.beside(chosen[:-1])
    own = body.vertices[body.corners(body.beside(alone))[:, 1]]
    place = body.places(half)
    for k in np.flatnonzero(half.across != cell):
        s = own @ half.outward[k] - place[k]
        if s.min() > -tolerance or s.max() < tolerance:
            continue
        split = cut(body, one_plane(half.outward[k], place[k], alone), tolerance).body
        parts = cell, body.count
        cells = chosen | np.isin(np.arange(split.count), parts)
        pieces = Pieces(split, cells, split.in_rock, kept)
        for part in parts:
            ends = [other for other in pieces.near(part) if other in near]
            if (other := pieces.fitting(part, ends, tolerance)) is not None:
                root = np.arange(split.count)
                root[part] = other
                return split.joined(root)
    return None
