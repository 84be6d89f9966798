"""Contradictions common to pillars and rock masses."""

from __future__ import annotations

from math import ceil, floor, log10
from typing import TYPE_CHECKING

from jointwave.cases.scene_type import AnyScene
from jointwave.cases.schema.joint import PARTS
from jointwave.cases.schema.pulse import shortest_period
from jointwave.cases.schema.values import contradiction

if TYPE_CHECKING:
    from jointwave.cases.schema.joint import JointLaw

MOST_SAMPLES = 10_000_000  # 80 MB for each section, point and energy term
MOST_SNAPSHOTS = 10_000
SNAP = 1 + 1e-6  # least ratio of the fracture energy to that of a vertical softening line


def check_time(scene: AnyScene) -> None:
    """Raise a contradiction between the sampling interval and the duration."""
    interval, duration = scene.interval, scene.time.duration
    if interval > duration:
        allowed = f"must not exceed time.duration = {duration:g}"
        if scene.record.interval is None and (period := shortest_period(scene.pulses)):
            allowed += f": absent, it is a 200th of the period, {period:g} s"
        raise contradiction("record.interval", interval, allowed)
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
    """Raise a contradiction of a quality factor with the loads, or with other damping of rock."""
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
        if not given:
            continue
        for key in part.instead_of:
            if (value := getattr(law, key)) is not None:
                allowed = f"contradicts {part.keys[0]}: give one of them"
                raise contradiction(f"{table}.{key}", value, allowed)
        if found := part.wrong(law):
            raise contradiction(f"{table}.{found[0]}", getattr(law, found[0]), found[1])
    residual, cohesion = law.residual_cohesion, law.cohesion
    if residual is not None and (cohesion is None or residual > cohesion):
        allowed = (
            "needs a cohesion" if cohesion is None else f"at most the cohesion {cohesion:g} Pa"
        )
        raise contradiction(f"{table}.residual_cohesion", residual, allowed)


def rounded_up(x: float) -> float:
    """Return the next number of four digits."""
    digit = 10.0 ** (floor(log10(x)) - 3)
    return ceil(x / digit) * digit
