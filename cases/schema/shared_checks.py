"""Contradictions that a pillar and a rock mass can have alike."""

from __future__ import annotations

from math import atan, ceil, degrees, floor, log10, radians, tan
from typing import TYPE_CHECKING

from cases.kinds import AnyScene
from cases.schema.joint import PARTS
from cases.schema.values import contradiction

if TYPE_CHECKING:
    from cases.schema.joint import JointLaw

MOST_SAMPLES = 10_000_000  # 80 MB for each section, point and energy term
MOST_SNAPSHOTS = 10_000
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


def check_quality(scene: AnyScene) -> None:
    """Raise a contradiction of a quality factor with what acts, or with other damping of rock."""
    quality = scene.rock.quality_factor
    if quality is None:
        return
    scene.rock.quality_frequencies(scene.pulses)
    if scene.rock.intact_modulus is None:
        allowed = "applies to the rock between joints: needs rock.intact_modulus"
        raise contradiction("rock.quality_factor", quality, allowed)
    if scene.damping.rayleigh is not None:
        allowed = "damping.rayleigh already damps the rock: give one of them"
        raise contradiction("rock.quality_factor", quality, allowed)


def check_strength(table: str, law: JointLaw) -> None:
    """Raise a contradiction between the keys of strength in one table, given by its path."""
    for part in PARTS:
        given = [key for key in part.all_keys if getattr(law, key) is not None]
        for key in part.keys if given else ():
            if key not in given:
                raise contradiction(f"{table}.{key}", None, f"is required with {table}.{given[0]}")
    if law.tension is not None and law.tensile_strength is not None:
        raise contradiction(
            f"{table}.tension", law.tension, "contradicts tensile_strength: give one of them"
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
    _check_rate(table, law)


def _check_rate(table: str, law: JointLaw) -> None:
    """Friction that depends on the rate is the whole of it, and as small as slip is slow: nothing
    could lift the faces."""
    if law.direct_effect is None:
        return
    if not law.friction_angle:
        raise contradiction(f"{table}.direct_effect", law.direct_effect, "needs a friction_angle")
    for key in ("dynamic_friction_angle", "dilation_angle"):
        if getattr(law, key) is not None:
            allowed = "direct_effect already makes friction rate-dependent: give one of them"
            raise contradiction(f"{table}.{key}", getattr(law, key), allowed)


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
            f"must be at most {most:.4g}, so that dilation stays below friction at "
            f"dynamic_friction_angle = {dynamic:g}"
        )
        raise contradiction(f"{table}.dilation_angle", dilation, allowed)


def rounded_up(x: float) -> float:
    """Return the next number of four digits."""
    digit = 10.0 ** (floor(log10(x)) - 3)
    return ceil(x / digit) * digit
