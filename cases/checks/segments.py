"""Contradictions of the segments of a pillar, and of random joints."""

from collections.abc import Iterator

from jointwave.cases.effects import off_axis
from jointwave.cases.material.jointed_rock import equivalent_constants
from jointwave.cases.partition.pillar import block_ends, welds
from jointwave.cases.schema.scene import Scene
from jointwave.cases.schema.segment import CLOSE, Segment
from jointwave.cases.schema.values import contradiction


def check_segments(scene: Scene) -> None:
    """Raise the first contradiction of the segments."""
    if scene.is_uniform:
        return
    if scene.block_count < 2:
        raise contradiction("segments", None, "must leave at least 2 blocks")
    for i, one in enumerate(scene.segments):
        _check_intact(f"segments[{i}]", one, scene)
    for key, value, allowed in (*_beside(scene), *_of_layers(scene)):
        if value is not None:
            raise contradiction(key, value, allowed)


def _check_intact(table: str, one: Segment, scene: Scene) -> None:
    rock = one.rock(scene.rock)
    if rock.intact_modulus is None:
        if not one.joints:
            raise contradiction(f"{table}.intact_modulus", None, "is required with joints = false")
        return
    given = None if one.normal_stiffness else equivalent_constants(rock)
    if one.joints and given and rock.intact_modulus <= given[0]:
        allowed = f"must exceed the equivalent modulus {given[0]:.4g}, or give joints = false"
        raise contradiction(f"{table}.intact_modulus", rock.intact_modulus, allowed)


def _beside(scene: Scene) -> Iterator[tuple[str, object, str]]:
    """Yield the keys that segments exclude: key, value (None if absent), reason."""
    numerics, why = scene.numerics, off_axis(scene)
    table, gives = ("segments", len(scene.segments)) if scene.segments else ("scatter", "given")
    yield table, why and gives, f"supports axial motion only, as pillar.joints does: {why}"
    gravity = None if scene.gravity is None else scene.gravity.acceleration
    yield "gravity.acceleration", gravity, "is not supported with segments or scatter"
    yield "numerics.continuum.mesh", numerics.continuum.mesh, "has no segments or scatter"
    rotation = "none" if scene.motion.rotation == "none" else None
    yield "motion.rotation", rotation, "suppresses lateral strain: not with segments or scatter"
    scheme = None if numerics.dem.scheme == "leapfrog" else numerics.dem.scheme
    yield (
        "numerics.dem.scheme",
        scheme,
        "needs blocks of equal mass: with segments or scatter give 'leapfrog'",
    )


def _of_layers(scene: Scene) -> Iterator[tuple[str, object, str]]:
    """Yield the same of soft layers, where these are on joints."""
    inner, no_joint = block_ends(scene)[1:-1], welds(scene)
    for i, layer in enumerate(scene.soft_layers):
        table = f"soft_layers[{i}]"
        yield (
            f"{table}.thickness",
            layer.thickness,
            "must be a segment when there are segments or scatter",
        )
        welded = no_joint[abs(inner - layer.y) <= CLOSE * scene.pillar.block].any()
        given = layer.normal_stiffness or layer.spacing_stiffness
        why = "needs a normal_stiffness: intact segments meet without a joint"
        yield f"{table}.y", layer.y if welded and not given else None, why
