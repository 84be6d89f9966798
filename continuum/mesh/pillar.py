"""The pillar of a scene as a mesh: straight pieces between the joints that cut it."""

from collections.abc import Mapping, Sequence
from itertools import pairwise
from math import ceil

import numpy as np

from jointwave.cases.material.calibrate import Properties
from jointwave.continuum.mesh import facets
from jointwave.continuum.mesh.cells import KINDS
from jointwave.continuum.mesh.description import Mesh, Part
from jointwave.continuum.mesh.extrusion import Column, extruded

#: Of the period: the longest travel time of a wave through one element. A load that starts like a
#: sine has a kink, which only dashpots smooth as it propagates.
TRAVEL_OF_KINKS, TRAVEL_OF_DAMPED = 0.01, 0.04

#: Of a block: tolerance for finding facets across the pillar by position.
PLACE = 1e-6


def elements_in_block(block: float, speed: float, period: float, damped: bool = False) -> int:
    """Return the least number of equal elements in a block (m) resolving waves of a speed (m/s).

    A wave crosses one element in at most 1/100 of the period (s), 1/25 in damped rock.
    """
    travel = TRAVEL_OF_DAMPED if damped else TRAVEL_OF_KINKS
    return max(1, ceil(block / (speed * travel * period) * (1 - 1e-9)))


def pillar_mesh(
    p: Properties,
    dim: int,
    cell: str,
    elements_per_block: int | Sequence[int],
    elements_across: int,
    interfaces: np.ndarray,
    layers: Mapping[int, float] | None = None,
) -> Mesh:
    """Return the mesh of a pillar cut at some of its joints.

    Parameters
    ----------
    dim, cell : 1 to 3, and "hexahedron" or "simplex" as in `numerics.continuum`.
    elements_per_block : equal elements in each block along y; or in the blocks of each segment.
    elements_across : elements in each direction of the section.
    interfaces : int array, the joints that cut the pillar, 0 nearest the loaded end.
    layers : thickness (m) of the joints that are layers of rock: bonded to the blocks on both
        sides, each of which is shortened by half of it; one element through each.

    Pieces of the same length are copies of one part. Raises ValueError for a joint that is both
    interface and layer, or a layer that is too thick for a block.
    """
    kind, layers = KINDS[dim, cell], dict(sorted((layers or {}).items()))
    each = [elements_per_block] if isinstance(elements_per_block, int) else elements_per_block
    _refuse_impossible(p, interfaces, layers)
    parts = []
    for first, last, starts in _pieces(p, np.unique(interfaces), np.array([*layers])):
        if not p.is_uniform:
            column = _segmented(p, first, last, each)
        else:
            column = _column(p, first, last, layers, each[0])
        shifts = np.zeros((starts.size, dim))
        shifts[:, min(1, dim - 1)] = p.contact_y[starts]
        parts.append(Part(*extruded(kind, p.side, elements_across, column), shifts))
    return _joined(p, kind, tuple(parts), tuple(layers))


def _refuse_impossible(p: Properties, interfaces: np.ndarray, layers: dict[int, float]) -> None:
    both = np.intersect1d(interfaces, [*layers])
    if both.size:
        raise ValueError(f"joint {both[0]:g} is both an interface and a layer")
    lost = np.zeros(p.block_count + 1)
    lost[[joint + 1 for joint in layers]] = [thickness / 2 for thickness in layers.values()]
    if (lost[1:] + lost[:-1] >= p.spacing).any():
        block = int((lost[1:] + lost[:-1]).argmax())
        raise ValueError(f"the layers leave nothing of block {block}, {p.spacing:g} m long")


def _pieces(
    p: Properties, cuts: np.ndarray, layers: np.ndarray
) -> list[tuple[int, int, np.ndarray]]:
    """Return first and past-the-last block of each distinct piece, and the starts of its copies.

    Pieces with a layer are distinct, because each layer is a material of its own; others are equal
    if they have the same number of blocks of the same segments.
    """
    ends = np.r_[0, cuts + 1, p.block_count].astype(np.int64)
    like = np.diff(ends)
    if not p.is_uniform:
        thickness = np.rint(np.diff(p.contact_y) / (PLACE * p.spacing)).astype(np.int64)
        blocks = np.stack([p.segment, thickness], axis=1)
        rows = [blocks[a:b].tobytes() for a, b in pairwise(ends)]
        like = np.unique(np.array(rows, dtype=object), return_inverse=True)[1].astype(np.int64)
    layered = np.unique(np.searchsorted(ends, layers + 1) - 1).astype(np.int64)
    like[layered] = -1 - np.arange(layered.size)
    _, first, kind = np.unique(like, return_index=True, return_inverse=True)
    return [
        (int(ends[piece]), int(ends[piece + 1]), ends[:-1][kind == kind[piece]])
        for piece in np.sort(first)
    ]


def _column(
    p: Properties,
    first: int,
    last: int,
    layers: dict[int, float],
    in_block: int,
) -> Column:
    """Return the rows of elements of blocks `first` to `last` - 1, and one for each layer."""
    edges, material, number = [], [], [*layers]

    def half(joint: int) -> float:
        return layers.get(joint, 0.0) / 2 if first <= joint < last - 1 else 0.0

    def add(begin: float, length: float, count: int, of: int) -> None:
        edges.append(begin + length / count * np.arange(count))
        material.append(np.full(count, of))

    for block in range(first, last):
        y, before, after = p.spacing * (block - first), half(block - 1), half(block)
        add(y + before, p.spacing - before - after, in_block, 0)
        if after:
            add(y + p.spacing - after, 2 * after, 1, 1 + number.index(block))
    edges.append(np.array([p.spacing * (last - first)]))
    return Column(np.concatenate(edges), np.concatenate(material))


def _segmented(p: Properties, first: int, last: int, elements: Sequence[int]) -> Column:
    """Return the rows of elements of blocks `first` to `last` - 1 of a pillar of segments."""
    y, own = p.contact_y[first : last + 1] - p.contact_y[first], p.segment[first:last]
    count = np.array(elements)[own]
    edges = [
        a + (b - a) / n * np.arange(n)
        for (a, b), n in zip(pairwise(y), count.tolist(), strict=True)
    ]
    return Column(np.append(np.concatenate(edges), y[-1]), np.repeat(own, count))


def _joined(p: Properties, kind: str, parts: tuple[Part, ...], layers: tuple[int, ...]) -> Mesh:
    """Return the mesh with its facets: the end faces, and the pairs between its parts' copies."""
    length, tolerance = p.spacing * p.block_count, PLACE * p.spacing
    outer = facets.outer_facets(kind, parts)
    start, end = (facets.lies_at(outer, y, tolerance) for y in (0.0, length))
    cut = outer.chosen(facets.lies_across(outer, tolerance) & ~start & ~end)
    pair = facets.pairs(cut)
    joint = np.searchsorted(p.centre_y, cut.y[pair[:, 0]]) - 1
    sides = {"start": outer.side(start), "end": outer.side(end)}
    return Mesh(kind, parts, layers, facets.joints(cut, pair, joint), sides)
