"""The facets of a scene's blocks, by kind, and the cells that the blocks are divided into."""

from typing import NamedTuple

import numpy as np

from jointwave.cases.geometry.blocks import Blocks, Facets
from jointwave.cases.geometry.cell_complex import Complex
from jointwave.cases.geometry.measure import facet_moments
from jointwave.cases.geometry.relations import composed


class Marks(NamedTuple):
    """What facets of a complex are: the column of the law of a resolved joint, or -1, and the
    index of the name of a side, or -1: int arrays [facets]. names : of sides."""

    column: np.ndarray
    side: np.ndarray
    names: tuple[str, ...]


def marks_of(blocks: Blocks, columns: np.ndarray, names: tuple[str, ...]) -> Marks:
    """Return the marks of the facets of blocks; columns : of each contact, -1 where it is no joint.

    names : of the sides that `blocks.boundary.side` numbers.
    """
    body, contacts = blocks.body, blocks.contacts
    column, side = np.full((2, len(body.sides)), -1)
    inner, outer = np.flatnonzero(body.inner), np.flatnonzero(~body.inner)
    own = _key(blocks, np.sort(body.sides[inner], axis=1), body.joint_set[inner])
    known = _key(blocks, contacts.blocks, contacts.joint_set)
    column[inner] = columns[np.searchsorted(known, own)]
    side[outer] = blocks.boundary.side[_pieces(body, outer, blocks.boundary)]
    return Marks(column, side, names)


def _key(blocks: Blocks, pairs: np.ndarray, joint_set: np.ndarray) -> np.ndarray:
    """Return a number for pairs of blocks [n, 2] and a joint set, in the order of contacts."""
    sets = int(blocks.body.joint_set.max(initial=0)) + 2
    return (pairs @ [blocks.count, 1]) * sets + joint_set + 1


def _pieces(body: Complex, outer: np.ndarray, boundary: Facets) -> np.ndarray:
    """Return the piece of the boundary that each outer facet belongs to: of its block and
    direction, and of these the nearest."""
    half = body.halves(outer)
    order = np.argsort(half.facet, kind="stable")
    block, normal = half.cell[order], half.outward[order]
    of_block = np.stack([boundary.blocks[:, 0], np.arange(len(boundary))], axis=1)
    pairs, which = composed(np.stack([np.arange(len(outer)), block], axis=1), of_block)
    piece, middle = pairs[:, 1], facet_moments(body, outer).centroid
    turned = np.linalg.norm(normal[which] - boundary.normal[piece], axis=1)
    away = np.linalg.norm(middle[which] - boundary.centroid[piece], axis=1)
    best = np.lexsort([away, np.round(turned, 9), which])
    return piece[best[np.searchsorted(which[best], np.arange(len(outer)))]]
