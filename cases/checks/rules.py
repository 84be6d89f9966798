"""Contradictions that any scene may have, and those within one joint law."""

from collections.abc import Iterator
from math import ceil, floor, log10

from jointwave.cases.scene_type import AnyScene
from jointwave.cases.schema.joint import JointLaw
from jointwave.cases.schema.law_parts import AGAINST_VISCOSITY, PARTS
from jointwave.cases.schema.pulse import shortest_period
from jointwave.cases.schema.segment import Segment

MOST_SAMPLES = 10_000_000  # 80 MB per section, point and energy term
MOST_SNAPSHOTS = 10_000
SNAP = 1 + 1e-6  # least ratio of the fracture energy to that of a vertical softening line

Wrong = tuple[str, object, str]  #: key, value, what is allowed


def within(table: str, found: Iterator[Wrong]) -> Iterator[Wrong]:
    """Yield contradictions with the full keys of their table, whose path replaces `{table}`."""
    for key, value, allowed in found:
        yield f"{table}.{key}", value, allowed.replace("{table}", table)


def of_time(scene: AnyScene) -> Iterator[Wrong]:
    """Yield contradictions between sampling interval, snapshot interval and duration."""
    interval, duration, fields = scene.interval, scene.time.duration, scene.record.fields
    if interval > duration:
        allowed = f"must not exceed time.duration = {duration:g}"
        if scene.record.interval is None and (period := shortest_period(scene.pulses)):
            allowed += f": absent, it is a 200th of the period, {period:g} s"
        yield "record.interval", interval, allowed
    if duration / interval > MOST_SAMPLES:
        yield "record.interval", interval, f"must give at most {MOST_SAMPLES:,} samples"
    if fields is not None and not interval * (1 - 1e-9) <= fields <= duration:
        span = f"the sampling interval {interval:g} s and time.duration = {duration:g}"
        yield "record.fields", fields, f"must lie between {span}"
    if fields is not None and duration / fields > MOST_SNAPSHOTS:
        yield "record.fields", fields, f"must give at most {MOST_SNAPSHOTS:,} snapshots"


def of_quality(scene: AnyScene) -> Iterator[Wrong]:
    """Yield contradictions between a quality factor and the loads, or other damping of the rock."""
    quality = scene.rock.quality_factor
    if quality is None:
        return
    scene.rock.quality_frequencies(scene.pulses)
    if scene.rock.intact_modulus is None:
        allowed = "applies to the rock between joints: needs rock.intact_modulus"
        yield "rock.quality_factor", quality, allowed
    if scene.damping.rayleigh is not None:
        allowed = "damping.rayleigh already damps the rock: give one of them"
        yield "rock.quality_factor", quality, allowed


def of_damping(law: JointLaw | Segment, scene: AnyScene) -> Iterator[Wrong]:
    """Yield dashpots of a joint that are given twice, also by Rayleigh damping."""
    viscosity = getattr(law, "viscosity", None)
    for key, value in {"damping_ratio": law.damping_ratio, "viscosity": viscosity}.items():
        if scene.damping.rayleigh is not None and value is not None:
            allowed = "damping.rayleigh already sets the dashpots: give one of them"
            yield key, value, allowed
    for key in AGAINST_VISCOSITY if viscosity is not None else ():
        if (value := getattr(law, key)) is not None:
            yield key, value, "contradicts viscosity: give one of them"


def of_strength(law: JointLaw) -> Iterator[Wrong]:
    """Yield contradictions between the strength keys of one table."""
    for part in PARTS:
        given = [key for key in part.all_keys if getattr(law, key) is not None]
        if not given:
            continue
        for key in part.keys:
            if key not in given:
                yield key, None, f"is required with {{table}}.{given[0]}"
        for key in part.instead_of:
            if (value := getattr(law, key)) is not None:
                yield key, value, f"contradicts {part.keys[0]}: give one of them"
        if found := part.wrong(law):
            yield found[0], getattr(law, found[0]), found[1]
    residual, cohesion = law.residual_cohesion, law.cohesion
    if residual is not None and (cohesion is None or residual > cohesion):
        most = "needs a cohesion" if cohesion is None else f"at most the cohesion {cohesion:g} Pa"
        yield "residual_cohesion", residual, most


def of_fracture(law: JointLaw, stiffness: float, symbol: str) -> Iterator[Wrong]:
    """Yield a joint that snaps back: its stress falls faster than its stiffness (Pa/m) unloads."""
    if law.tensile_strength is None or law.fracture_energy is None:
        return
    least = SNAP * law.tensile_strength**2 / (2 * stiffness)
    if law.fracture_energy < least:
        digit = 10.0 ** (floor(log10(least)) - 3)
        allowed = (
            f"must exceed tensile_strength^2 / (2 {symbol}), or the joint snaps back: at least "
            f"{ceil(least / digit) * digit:.4g} J/m2"
        )
        yield "fracture_energy", law.fracture_energy, allowed
