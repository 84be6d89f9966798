"""Pressures, forces and compliant bases of a rock mass as forces on its blocks."""

from __future__ import annotations

import numpy as np

from jointwave.cases.geometry.blocks import Blocks
from jointwave.cases.geometry.locate import blocks_at
from jointwave.cases.geometry.measure import Outlines
from jointwave.cases.loads import velocity_of
from jointwave.cases.material.quiet_sides import base_traction, impedances
from jointwave.cases.partition.parts import covered
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.cases.schema.sources import PlaneLoad
from jointwave.dem.boundaries import facets_on, points_on
from jointwave.dem.loads import Pattern


def load_pattern(
    scene: RockMass, blocks: Blocks, sides: tuple[str, ...], load: PlaneLoad
) -> Pattern:
    """Return a pressure, a force or a compliant base of a scene; sides : the names of the blocks'
    sides, in order."""
    history = velocity_of(load, load.amplitude)
    if load.kind == "force":
        at = np.array(load.at)
        block = blocks_at(blocks, at[None])[0][:1]
        return Pattern(block, at - blocks.centroid[block], np.array([load.direction]), history)
    facets, parts = facets_on(blocks, sides, [load.side or f"opening {load.opening}"]), None
    if load.between is not None:
        facets, parts = _covered(scene, blocks, load, facets)
    points = points_on(blocks, facets, parts)
    if load.kind == "base":
        assert load.direction is not None
        impedance = impedances(scene, points.normal, blocks.body.region[points.block])
        traction = base_traction(points.normal, impedance, load.direction)
    else:
        traction = -points.normal
    return Pattern(points.block, points.arm, points.area[:, None] * traction, history)


def _covered(
    scene: RockMass, blocks: Blocks, load: PlaneLoad, facets: np.ndarray
) -> tuple[np.ndarray, Outlines]:
    """Return those of some edges that a load acts on in part, and these parts of them."""
    edges = blocks.boundary.ends[facets]
    part = covered(scene.domain, load, edges)
    acts = part[:, 1] > part[:, 0]
    start, end = edges[acts, :1], edges[acts, 1:]
    place = part[acts, :, None]
    ends = start * (1 - place) + end * place
    return facets[acts], Outlines(ends.reshape(-1, 2), 2 * np.arange(acts.sum() + 1))
