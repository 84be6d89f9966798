"""Segments of a pillar whose rock, joints or block thickness differ from the rest."""

from typing import Annotated, NamedTuple

from pydantic import model_validator

from jointwave.cases.schema.joint import Joints
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
    Increasing,
    NonNegative,
    Poisson,
    Positive,
    Table,
    Two,
    Words,
    contradiction,
)

CLOSE = 1e-6  # rounding of lengths, over the block thickness
#: Keys that an intact segment cannot have.
OF_JOINTED = (*SPEEDS, *CONSTANTS, "normal_stiffness", "damping_ratio")


class Segment(Table):
    """A length of the pillar; absent keys are taken from [rock], [joints] and [pillar]."""

    y: Annotated[list[NonNegative], Two, Increasing]  #: m, its start and end
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
    def _is_one(self) -> "Segment":
        for key in OF_JOINTED:
            if not self.joints and getattr(self, key) is not None:
                allowed = "applies to jointed rock: with {table}.joints = false give intact_modulus"
                raise contradiction(f".{key}", getattr(self, key), allowed)
        if sorted(map(len, given := given_pairs(self))) not in ([0, 0], [0, 2]):
            key = (given[0] + given[1])[0]
            raise contradiction(f".{key}", getattr(self, key), f"give one pair or none: {PAIRS}")
        if wrong := wrong_speeds(self):
            raise contradiction(".p_speed", self.p_speed, wrong)
        check_given_once("{table}", self, "", self)
        return self

    @property
    def is_other_mass(self) -> bool:
        """Whether the segment gives elastic constants of its rock mass."""
        return self.p_speed is not None or self.equivalent_modulus is not None

    def rock(self, rest: Rock) -> Rock:
        """Return the segment's rock; absent keys come from the rest of the pillar."""
        own = {k: v for k in Rock.model_fields if (v := getattr(self, k, None)) is not None}
        if self.is_other_mass or not self.joints:
            own = dict.fromkeys((*SPEEDS, *CONSTANTS)) | own
        rock = rest.model_copy(update=own)
        if self.joints:
            return rock
        intact = dict(zip(CONSTANTS, (rock.intact_modulus, rock.intact_poisson), strict=True))
        return rock.model_copy(update=intact)

    def law(self, rest: Joints) -> Joints:
        """Return the joint law of the segment; absent keys come from the rest of the pillar."""
        keys = ("normal_stiffness", "damping_ratio")
        own = {key: value for key in keys if (value := getattr(self, key)) is not None}
        if self.is_other_mass or not self.joints:
            own = {"normal_stiffness": None} | own
        if not self.joints:
            own = own | {"damping_ratio": None}
        return rest.model_copy(update=own)


class Part(NamedTuple):
    """A part of a pillar with one rock: start and stop (m), number of blocks, and index of its
    segment (None if [rock] applies)."""

    start: float
    stop: float
    blocks: int
    segment: int | None


def parts_of(pillar: Pillar, segments: list[Segment]) -> list[Part]:
    """Return the parts of a pillar from its loaded end on; one part without segments. Raises a
    contradiction if segments overlap or blocks do not divide them."""
    found, at = list[Part](), 0.0
    if not segments:
        return [Part(0.0, pillar.length, pillar.block_count, None)]
    close, block = CLOSE * pillar.block, ("pillar.block", pillar.block)
    for i, one in sorted(enumerate(segments), key=lambda item: item[1].y[0]):
        (start, stop), key = one.y, f"segments[{i}].y"
        if start < at - close:
            raise contradiction(key, one.y, f"overlaps the segment that ends at {at:g} m")
        if stop > pillar.length + close:
            raise contradiction(key, one.y, f"must end within pillar.length = {pillar.length:g}")
        if start > at + close:
            found.append(_part(at, start, pillar.block, None, *block))
        whole = (key, one.y) if one.block is None else (f"segments[{i}].block", one.block)
        found.append(_part(start, stop, one.block or pillar.block, i, *whole))
        at = stop
    if pillar.length > at + close:
        found.append(_part(at, pillar.length, pillar.block, None, *block))
    return found


def _part(
    start: float, stop: float, block: float, segment: int | None, key: str, value: object
) -> Part:
    count = (stop - start) / block
    if count > MOST_BLOCKS:
        raise contradiction(
            key, value, f"must give at most {MOST_BLOCKS:,} blocks, not {count:.3g}"
        )
    if abs(count - round(count)) > CLOSE * max(count, 1) or round(count) < 1:
        allowed = f"blocks of {block:g} m must divide the pillar from {start:g} to {stop:g} m"
        raise contradiction(key, value, allowed)
    return Part(start, stop, round(count), segment)
