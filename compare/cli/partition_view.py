"""Output of `jointwave explain` for a rock mass: the blocks that it is cut into."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from cases.errors import SceneError
from cases.size import spoken
from compare.cli.terminal import say, show_table

if TYPE_CHECKING:
    from cases.partition.blocks import Partition
    from cases.schema.rock_mass import RockMass


ROUND_OFF = 1e-6  # of a stiffness that is fitted


def partition_facts(scene: RockMass) -> dict[str, Any]:
    """Cut a rock mass into blocks and return what they are, SI."""
    from cases.partition.lattice import further_sets
    from cases.partition.scene import partition_bytes, partition_of

    found, further = partition_of(scene), further_sets(scene)
    per_set = {name: _of_set(found, k) for k, name in enumerate(found.joint_sets)}
    sides = np.bincount(found.boundary.side, minlength=len(found.sides))
    return {
        "blocks": found.count,
        "rigid_blocks": partition_of(scene, further).count if further else found.count,
        "area": float(found.area.sum()),
        "smallest": _block(found, int(np.argmin(found.area))),
        "largest": _block(found, int(np.argmax(found.area))),
        "regions": _regions(scene, found),
        "joint_sets": per_set,
        "cuts_through_rock": _of_set(found, -1),
        "boundary": {name: int(n) for name, n in zip(found.sides, sides, strict=True) if n},
        "bytes": found.nbytes,
        "bytes_at_most": partition_bytes(scene),
        "rigid_blocks_lack": _lack(scene),
    }


def _regions(scene: RockMass, found: Partition) -> dict[str, Any]:
    """Return what each region is, with what is left as "rock"; empty where there is none."""
    from cases.material.rock import elastic_rock
    from cases.partition.regions import rocks_of
    from cases.schema.region import REST

    facts = {}
    names = [*(one.name for one in scene.regions), REST]
    for k, (name, rock) in enumerate(zip(names, rocks_of(scene), strict=True)):
        own, elastic = found.region % len(names) == k, elastic_rock(rock)
        facts[name] = {
            "blocks": int(own.sum()),
            "area": float(found.area[own].sum()),
            "p_speed": float(elastic.p_speed),
            "s_speed": float(elastic.s_speed),
        }
    return facts if scene.regions else {}


def _lack(scene: RockMass) -> float | None:
    """Return the part of the intact rock's stiffness that rigid blocks cannot have; None where
    there are no rigid blocks."""
    from cases.material.rigid_blocks import rigid_joints
    from cases.partition.lattice import further_sets

    try:
        return rigid_joints(scene, further_sets(scene)).left_over
    except SceneError:
        return None


def show_partition(facts: dict[str, Any]) -> None:
    """Print the blocks of a rock mass."""
    say(f"{facts['blocks']:,} blocks, {facts['area']:.6g} m2 in total")
    if facts["rigid_blocks"] != facts["blocks"]:
        say(f"{facts['rigid_blocks']:,} rigid blocks: numerics.dem.block subdivides the rock")
    for word in ("smallest", "largest"):
        one = facts[word]
        x, y = one["centroid"]
        say(f"{word} block: {one['area']:.4g} m2, at [{x:.4g}, {y:.4g}]")
    for name, one in facts["regions"].items():
        speeds = f"waves of {one['p_speed']:.4g} and {one['s_speed']:.4g} m/s"
        say(f"region {name}: {one['blocks']:,} blocks, {one['area']:.6g} m2, {speeds}")
    cuts = facts["cuts_through_rock"]
    sets = facts["joint_sets"] | ({"(no joint)": cuts} if cuts["contacts"] else {})
    rows = [[name, f"{one['contacts']:,}", f"{one['length']:.6g}"] for name, one in sets.items()]
    show_table(["joint set", "contacts", "length, m"], rows)
    show_table(["side", "edges"], [[name, f"{n:,}"] for name, n in facts["boundary"].items()])
    at_most = spoken(facts["bytes_at_most"])
    if (lack := facts["rigid_blocks_lack"]) is not None:
        share, why = "0", "their joints represent all of it"
        if lack > ROUND_OFF:
            share = f"{100 * lack:.2g}"
            why = "only their joints deform, and joints of few directions have no Poisson effect"
        say(f"rigid blocks cannot represent {share} % of the intact rock's stiffness: {why}")
    say(f"memory of the blocks: {spoken(facts['bytes'])}, at most {at_most} during subdivision")


def _of_set(found: Partition, index: int) -> dict[str, Any]:
    own = found.contacts.joint_set == index
    return {"contacts": int(own.sum()), "length": float(found.contacts.length[own].sum())}


def _block(found: Partition, one: int) -> dict[str, Any]:
    return {"area": float(found.area[one]), "centroid": found.centroid[one].tolist()}
