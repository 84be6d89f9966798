"""Contacts across periodic sides: of the blocks at one side with those at the other."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from jointwave.cases.geometry.blocks import Blocks, Facets
from jointwave.cases.geometry.periodic import contacts_across
from jointwave.cases.partition.shape import SIDES
from jointwave.cases.schema.rock_mass import RockMass


class Across(NamedTuple):
    """Contacts across a pair of periodic sides, of a joint set where a joint lies along both sides:
    block i at the far side, block j, in no order, at the near one. Ends and normals are those at
    block i. shift : [d], m, offset of blocks j. sides : names of the pair, the near one first."""

    contacts: Facets
    shift: np.ndarray
    sides: tuple[str, str]


def across_periodic(scene: RockMass, blocks: Blocks) -> list[Across]:
    """Return the contacts across the periodic sides of a scene; raises GeometryError where they do
    not fit each other."""
    x, dim = blocks.body.vertices, blocks.body.dim
    shifts, names = np.diag(np.ptp(x, axis=0)), [one.name for one in scene.joint_sets]
    pairs = zip(SIDES[dim][:-1:2], SIDES[dim][1::2], strict=True)
    return [
        Across(contacts_across(blocks, axis, pair, names), shifts[axis], pair)
        for axis, pair in enumerate(pairs)
        if getattr(scene.boundaries, pair[0]) == "periodic"
    ]


def of_all(blocks: Blocks, across: Sequence[Across], key: str) -> np.ndarray:
    """Return an array of all contacts, those across periodic sides last."""
    parts = blocks.contacts, *(one.contacts for one in across)
    return np.concatenate([getattr(part, key) for part in parts])
