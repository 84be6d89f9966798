"""Contradictions that a pillar and a rock mass can have alike."""

from __future__ import annotations

from math import atan, ceil, degrees, floor, log10, radians, tan
from typing import TYPE_CHECKING

from cases.schema.values import contradiction

if TYPE_CHECKING:
    from cases.kinds import AnyScene
    from cases.schema.joint import JointLaw

MOST_SAMPLES = 10_000_000  # 80 MB for each section, point and energy term
MOST_SNAPSHOTS = 10_000
#: Keys of a joint that need one another.
PAIRS = (
    ("tensile_strength", "fracture_energy"),
    ("dynamic_friction_angle", "weakening_distance"),
    ("dilation_angle", "dilation_distance"),
)
SNAP = 1 + 1e-6  # how far the fracture energy must stay from a vertical softening line


def check_time(scene: AnyScene) -> None:
    """Raise a contradiction between the sampling interval and the duration."""
    interval, duration = scene.interval, scene.time.duration
    if interval > duration:
        raise contradiction(
            "record.interval", interval, f"must not exceed time.duration = {duration:g}"
        )
    if duration / interval > MOST_SAMPLES:
        raise contradiction(
            "record.interval", interval, f"must give at most {MOST_SAMPLES:,} samples"
        )


def check_fields(scene: AnyScene) -> None:
    """Raise a contradiction between the times of snapshots, of samples and the duration."""
    fields, interval, duration = scene.record.fields, scene.interval, scene.time.duration
    if fields is None:
        return
    if not interval * (1 - 1e-9) <= fields <= duration:
        raise contradiction(
            "record.fields",
            fields,
            f"must lie between the sampling interval {interval:g} s and time.duration = "
            f"{duration:g}",
        )
    if duration / fields > MOST_SNAPSHOTS:
        raise contradiction(
            "record.fields", fields, f"must give at most {MOST_SNAPSHOTS:,} snapshots"
        )


def check_strength(table: str, law: JointLaw) -> None:
    """Raise a contradiction between the keys of strength in one table, given by its path."""
    for pair in PAIRS:
        for key, other in (pair, pair[::-1]):
            if getattr(law, key) is None and getattr(law, other) is not None:
                raise contradiction(f"{table}.{key}", None, f"is needed with {table}.{other}")
    if law.tension is not None and law.tensile_strength is not None:
        raise contradiction(
            f"{table}.tension", law.tension, "tensile_strength says otherwise: give one of them"
        )
    residual, cohesion = law.residual_cohesion, law.cohesion
    if residual is not None and (cohesion is None or residual > cohesion):
        allowed = (
            "needs a cohesion" if cohesion is None else f"at most the cohesion {cohesion:g} Pa"
        )
        raise contradiction(f"{table}.residual_cohesion", residual, allowed)
    for key in ("dynamic_friction_angle", "dilation_angle"):
        angle, static = getattr(law, key), law.friction_angle
        if angle is not None and static is None:
            raise contradiction(f"{table}.{key}", angle, "needs a friction_angle")
        if angle is not None and angle > static:
            allowed = f"must be at most friction_angle = {static:g}"
            raise contradiction(f"{table}.{key}", angle, allowed)
    _check_dilation(table, law)


def _check_dilation(table: str, law: JointLaw) -> None:
    """What lifts the faces must not take more work than friction gives: both tangents are linear in
    the path, so that the ends of the weakening decide."""
    dilation, dynamic = law.dilation_angle, law.dynamic_friction_angle
    distance = law.weakening_distance
    if dilation is None or law.dilation_distance is None or dynamic is None or distance is None:
        return
    share = max(1 - distance / law.dilation_distance, 0.0)
    if share * tan(radians(dilation)) > tan(radians(dynamic)):
        most = degrees(atan(tan(radians(dynamic)) / share))
        allowed = (
            f"must be at most {most:.4g}: what is left of it where friction has fallen to "
            f"dynamic_friction_angle = {dynamic:g} must not exceed that"
        )
        raise contradiction(f"{table}.dilation_angle", dilation, allowed)


def rounded_up(x: float) -> float:
    """Return the next number of four digits."""
    digit = 10.0 ** (floor(log10(x)) - 3)
    return ceil(x / digit) * digit
