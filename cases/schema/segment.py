"""Segments of a pillar: lengths of other rock, joints or block thickness than the rest."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated, NamedTuple

from pydantic import Field, model_validator

from jointwave.cases.schema.tables import (
    CONSTANTS,
    MOST_BLOCKS,
    PAIRS,
    SPEEDS,
    Pillar,
    Rock,
    check_given_once,
    given_pairs,
    wrong_speeds,
)
from jointwave.cases.schema.values import (
    NonNegative,
    Poisson,
    Positive,
    Table,
    Words,
    contradiction,
    contradiction_here,
)

if TYPE_CHECKING:
    from jointwave.cases.schema.scene import Scene

CLOSE = 1e-6  # of a block: rounding of lengths
#: Keys that an intact segment does not take.
OF_JOINTED = (*SPEEDS, *CONSTANTS, "normal_stiffness", "damping_ratio")


class Segment(Table):
    """A length of the pillar; absent keys are taken from [rock], [joints] and [pillar]."""

    y: Annotated[list[NonNegative], Field(min_length=2, max_length=2)]  #: m, its start and end
    name: Words | None = None  #: used in drawings and `explain`
    joints: bool = True  #: False: an intact bar, divided into welded blocks
    block: Positive | None = None  #: m, block thickness = joint spacing
    density: Positive | None = None  #: kg/m3
    p_speed: Positive | None = None  #: m/s, unbounded rock mass
    s_speed: Positive | None = None  #: m/s
    equivalent_modulus: Positive | None = None  #: Pa, E_eq of the rock mass
    equivalent_poisson: Poisson | None = None  #: of the rock mass
    intact_modulus: Positive | None = None  #: Pa, E of the blocks
    intact_poisson: Poisson | None = None  #: of the blocks
    normal_stiffness: Positive | None = None  #: Pa/m, its joints' own K_n
    damping_ratio: NonNegative | None = None  #: zeta of its joints

    @model_validator(mode="after")
    def _is_one(self) -> Segment:
        if not self.y[0] < self.y[1]:
            raise contradiction_here("y", self.y, "must be two increasing numbers")
        for key in OF_JOINTED:
            if not self.joints and getattr(self, key) is not None:
                allowed = "applies to jointed rock: with {table}.joints = false give intact_modulus"
                raise contradiction_here(key, getattr(self, key), allowed)
        if sorted(map(len, given := given_pairs(self))) not in ([0, 0], [0, 2]):
            key = (given[0] + given[1])[0]
            raise contradiction_here(key, getattr(self, key), f"give one pair or none: {PAIRS}")
        if wrong := wrong_speeds(self):
            raise contradiction_here("p_speed", self.p_speed, wrong)
        check_given_once("{table}", self, "", self)
        return self

    @property
    def is_other_mass(self) -> bool:
        """Whether it gives the elastic constants of its rock mass."""
        return self.p_speed is not None or self.equivalent_modulus is not None

    def rock(self, rest: Rock) -> Rock:
        """Return the segment's rock, given that of the rest of the pillar."""
        own = {k: v for k in Rock.model_fields if (v := getattr(self, k, None)) is not None}
        if self.is_other_mass or not self.joints:
            own = dict.fromkeys((*SPEEDS, *CONSTANTS)) | own
        rock = rest.model_copy(update=own)
        if self.joints:
            return rock
        intact = dict(zip(CONSTANTS, (rock.intact_modulus, rock.intact_poisson), strict=True))
        return rock.model_copy(update=intact)


class Region(NamedTuple):
    """A part of a pillar that has one rock: from start to stop (m), its number of blocks, and the
    index of its segment, None of what [rock] describes."""

    start: float
    stop: float
    blocks: int
    segment: int | None

    def pillar(self, side: float) -> Pillar:
        """Return it as a pillar of its own; one block will do."""
        length = self.stop - self.start
        return Pillar.model_construct(length=length, side=side, block=length / self.blocks)


def regions(scene: Scene) -> list[Region]:
    """Return the parts of a pillar from its loaded end on: one without segments.

    Raises a contradiction where segments overlap or blocks do not divide them.
    """
    pillar, found, at = scene.pillar, [], 0.0
    if not scene.segments:
        return [Region(0.0, pillar.length, pillar.block_count, None)]
    close = CLOSE * pillar.block
    for i, one in sorted(enumerate(scene.segments), key=lambda item: item[1].y[0]):
        (start, stop), key = one.y, f"segments[{i}].y"
        if start < at - close:
            raise contradiction(key, one.y, f"overlaps the segment that ends at {at:g} m")
        if stop > pillar.length + close:
            raise contradiction(key, one.y, f"must end within pillar.length = {pillar.length:g}")
        if start > at + close:
            found.append(_region(at, start, pillar.block, None, "pillar.block", pillar.block))
        whole = (key, one.y) if one.block is None else (f"segments[{i}].block", one.block)
        found.append(_region(start, stop, one.block or pillar.block, i, *whole))
        at = stop
    if pillar.length > at + close:
        found.append(_region(at, pillar.length, pillar.block, None, "pillar.block", pillar.block))
    return found


def _region(
    start: float, stop: float, block: float, segment: int | None, key: str, value: object
) -> Region:
    count = (stop - start) / block
    if count > MOST_BLOCKS:
        raise contradiction(
            key, value, f"must give at most {MOST_BLOCKS:,} blocks, not {count:.3g}"
        )
    if abs(count - round(count)) > CLOSE * max(count, 1) or round(count) < 1:
        allowed = f"blocks of {block:g} m must divide the pillar from {start:g} to {stop:g} m"
        raise contradiction(key, value, allowed)
    return Region(start, stop, round(count), segment)


def alone(scene: Scene, region: Region) -> Scene:
    """Return a region as a scene of one rock without soft layers; it is not validated."""
    update = {"pillar": region.pillar(scene.pillar.side), "segments": [], "soft_layers": []}
    update |= {"scatter": None}
    if region.segment is None:
        return scene.model_copy(update=update)
    one = scene.segments[region.segment]
    keys = ("normal_stiffness", "damping_ratio")
    own = {key: value for key in keys if (value := getattr(one, key)) is not None}
    if one.is_other_mass or not one.joints:
        own = {"normal_stiffness": None} | own
    if not one.joints:
        own = own | {"damping_ratio": None}
    joints = scene.joints.model_copy(update=own)
    return scene.model_copy(update={**update, "rock": one.rock(scene.rock), "joints": joints})


def check_segments(scene: Scene) -> None:
    """Raise the first contradiction of the segments."""
    if scene.is_uniform:
        return
    if sum(one.blocks for one in regions(scene)) < 2:
        raise contradiction("segments", None, "must leave at least 2 blocks")
    for i, one in enumerate(scene.segments):
        _check_intact(f"segments[{i}]", one, scene)
    for key, value, allowed in (*_beside(scene), *_of_layers(scene)):
        if value is not None:
            raise contradiction(key, value, allowed)


def _check_intact(table: str, one: Segment, scene: Scene) -> None:
    from jointwave.cases.material.stiffness import equivalent_constants

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
    from jointwave.cases.effects import off_axis

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
    from jointwave.cases.material.contacts import contacts, welds

    inner, no_joint = contacts(scene)[1:-1], welds(scene)
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
