"""Contradictions of the segments of a pillar, and of random joints."""

from collections.abc import Iterator

from jointwave.cases.checks.scene import Wrong, within
from jointwave.cases.effects import off_axis
from jointwave.cases.material.jointed_rock import equivalent_constants
from jointwave.cases.partition.pillar import block_ends, welds
from jointwave.cases.schema.scene import Scene
from jointwave.cases.schema.segment import CLOSE, Segment


def of_segments(scene: Scene) -> Iterator[Wrong]:
    """Yield contradictions of the segments, and what they and random joints exclude."""
    if scene.is_uniform:
        return
    if scene.block_count < 2:
        yield "segments", None, "must leave at least 2 blocks"
    for i, one in enumerate(scene.segments):
        yield from within(f"segments[{i}]", _of_intact(one, scene))
    yield from _beside(scene)
    yield from _of_layers(scene)


def _of_intact(one: Segment, scene: Scene) -> Iterator[Wrong]:
    rock = one.rock(scene.rock)
    if rock.intact_modulus is None:
        if not one.joints:
            yield "intact_modulus", None, "is required with joints = false"
        return
    given = None if one.normal_stiffness else equivalent_constants(rock)
    if one.joints and given and rock.intact_modulus <= given[0]:
        allowed = f"must exceed the equivalent modulus {given[0]:.4g}, or give joints = false"
        yield "intact_modulus", rock.intact_modulus, allowed


def _beside(scene: Scene) -> Iterator[Wrong]:
    """Yield the keys that segments and random joints exclude."""
    mesh, scheme = scene.numerics.continuum.mesh, scene.numerics.dem.scheme
    if why := off_axis(scene):
        table, count = "segments" if scene.segments else "scatter", len(scene.segments)
        yield table, count or "given", f"supports axial motion only, as pillar.joints does: {why}"
    if scene.gravity is not None and scene.gravity.acceleration:
        allowed = "is not supported with segments or scatter"
        yield "gravity.acceleration", scene.gravity.acceleration, allowed
    if mesh is not None:
        yield "numerics.continuum.mesh", mesh, "has no segments or scatter"
    if scene.motion.rotation == "none":
        allowed = "suppresses lateral strain: not with segments or scatter"
        yield "motion.rotation", "none", allowed
    if scheme != "leapfrog":
        allowed = "needs blocks of equal mass: with segments or scatter give 'leapfrog'"
        yield "numerics.dem.scheme", scheme, allowed


def _of_layers(scene: Scene) -> Iterator[Wrong]:
    """Yield the same of soft layers, where these are on joints."""
    inner, no_joint = block_ends(scene)[1:-1], welds(scene)
    for i, layer in enumerate(scene.soft_layers):
        if layer.thickness is not None:
            allowed = "must be a segment when there are segments or scatter"
            yield f"soft_layers[{i}].thickness", layer.thickness, allowed
        welded = no_joint[abs(inner - layer.y) <= CLOSE * scene.pillar.block].any()
        if welded and not (layer.normal_stiffness or layer.spacing_stiffness):
            allowed = "needs a normal_stiffness: intact segments meet without a joint"
            yield f"soft_layers[{i}].y", layer.y, allowed
