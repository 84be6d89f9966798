"""Scenes for measuring costs: the paper's pillar and a lattice of blocks, with effects."""

from __future__ import annotations

from collections.abc import Iterable
from math import isqrt
from pathlib import Path
from typing import TYPE_CHECKING, Any

import cases
from cases.kinds import AnyScene, pillar_of
from cases.schema.joint import PARTS
from cases.schema.law_part import LawPart
from cases.schema.scene import Scene
from cases.validate import validated

if TYPE_CHECKING:
    from cases.schema.rock_mass import RockMass

PILLAR = Path(cases.__file__).parent / "guo-li-2002" / "fig-03.toml"
BLOCKS = 1000  # of the pillar used to compare effects

#: A blow that moves blocks in all degrees of freedom.
ACROSS = {"load.direction": [0.6, 0.8, 0.0], "load.at": [0.1, 0.05]}


def _together(parts: Iterable[LawPart]) -> list[LawPart]:
    """Return the parts of a joint that can have as many of them as their keys allow."""
    found: list[LawPart] = []
    for part in parts:
        rest = {key for one in found for key in one.instead_of}
        keys = {key for one in found for key in one.all_keys}
        if not keys & {*part.instead_of} and not rest & {*part.all_keys}:
            found.append(part)
    return found


def _sample(parts: Iterable[LawPart]) -> dict[str, Any]:
    return {key: value for part in parts for key, value in part.sample.items()}


FIRST = _together(PARTS)
SECOND = _together(part for part in PARTS if part not in FIRST)

#: All effects together: the reference for a scene's own cost.
EVERYTHING = {
    **ACROSS,
    "motion.rotation": "finite",
    "joints.damping_ratio": 0.02,
    "joints.friction_angle": 30.0,
    "joints.cohesion": 1e5,
    "joints.residual_cohesion": 0.0,
    **{f"joints.{key}": value for key, value in _sample(FIRST).items()},
    "soft_layers": [{"y": 0.5, "spacing_stiffness": 4.375e8}],
    "record.stress": [0.5],
    "damping.mass_proportional": 1.0,
    "gravity": {"direction": [1, 0, 0], "static": False},
    "ends.start": "matched",
    "ends.end": "quiet",
}

ELASTIC = {"normal_stiffness": 1e10, "shear_stiffness": 4e9}
STEP = {"shape": "step", "amplitude": 1e5}
#: All effects together, except periodic sides: the reference for a scene's cost.
EVERYTHING_IN_PLANE: dict[str, Any] = {
    "boundaries": {"left": "quiet", "right": "quiet", "bottom": "fixed"},
    "waves": [STEP | {"kind": "P", "direction": [1.0, 0.0]}],
    "loads": [
        STEP | {"kind": "pressure", "side": "top"},
        STEP
        | {"kind": "base", "side": "bottom", "direction": [1.0, 0.0]}
        | {"quantity": "velocity", "amplitude": 1e-3},
    ],
    "damping": {"mass_proportional": 1.0, "local": 0.1},
    "gravity": {"static": False},
    "prestress": {"xx": 1e5, "yy": 1e5},
    "record": {"points": [[0.5, 0.5]]},
}
FRICTION = {"damping_ratio": 0.02, "friction_angle": 30.0, "cohesion": 1e6}
#: Its joints along y and along x.
FAILING = (
    ELASTIC | FRICTION | _sample(FIRST) | {"residual_cohesion": 0.0},
    ELASTIC | FRICTION | _sample(SECOND) | {"tension": False},
)


def changed(changes: dict, blocks: int = BLOCKS) -> Scene:
    """Return the paper's pillar with this number of blocks and some dotted keys changed."""
    return pillar_of(cases.load_variant(PILLAR, "", {"pillar.length": 0.5 * blocks, **changes}))


def everything(blocks: int) -> Scene:
    """Return the paper's pillar with every effect and this number of blocks, at most BLOCKS: with
    few blocks the fixed cost of a step matters."""
    return changed(EVERYTHING, min(max(blocks, 2), BLOCKS))


def everything_like(scene: AnyScene) -> AnyScene:
    """Return a scene of this kind with every effect and about as many rigid blocks."""
    if isinstance(scene, Scene):
        return everything(scene.block_count)
    return everything_in_plane(scene, BLOCKS)


def lattice(blocks: int, along_y: dict, along_x: dict, tables: dict[str, Any]) -> RockMass:
    """Return a square lattice of about this number of 1 m blocks, free unless tables set otherwise.

    along_y, along_x : law of the joints in that direction. tables : of the scene, replacing ours.
    """
    side = max(2, isqrt(blocks))
    joints = {"spacing": 1.0, "through": [0.0, 0.0]}
    sets = [
        {"name": "x", "dip": 90.0} | joints | along_y,
        {"name": "y", "dip": 0.0} | joints | along_x,
    ]
    ours = {
        "title": "a square lattice",
        "domain": {"size": [float(side), float(side)]},
        "rock": {"density": 2600.0, "intact_modulus": 5e10},
        "joint_sets": sets,
        "time": {"duration": 0.01},
        "record": {"points": [[0.5, 0.5]], "energy": False},
    }
    return validated(ours | tables, Path("lattice.toml"), frozenset())


def everything_in_plane(scene: RockMass, most: int) -> RockMass:
    """Return a lattice with every effect and the scene's number of blocks, at most `most`."""
    from dem.blocks.build import rigid_blocks

    blocks = min(rigid_blocks(scene).partition.count, most)
    return lattice(blocks, *FAILING, EVERYTHING_IN_PLANE)
