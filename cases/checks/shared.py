"""Contradictions common to pillars and rock masses."""

from collections.abc import Callable
from math import ceil, floor, log10

from pydantic_core import PydanticCustomError

from jointwave.cases.scene_type import AnyScene
from jointwave.cases.schema.joint import JointLaw
from jointwave.cases.schema.law_parts import PARTS
from jointwave.cases.schema.pulse import shortest_period
from jointwave.cases.schema.segment import Segment
from jointwave.cases.schema.values import contradiction

MOST_SAMPLES = 10_000_000  # 80 MB for each section, point and energy term
MOST_SNAPSHOTS = 10_000
SNAP = 1 + 1e-6  # least ratio of the fracture energy to that of a vertical softening line


def found_by(*checks: Callable[[], None]) -> list[PydanticCustomError]:
    """Return the contradictions that checks raise; what stops a check after one is taken for its
    consequence."""
    found: list[PydanticCustomError] = []
    for one in checks:
        try:
            one()
        except PydanticCustomError as error:
            found.append(error)
        except Exception:
            if not found:
                raise
    return found


def check_time(scene: AnyScene) -> None:
    """Raise a contradiction between the sampling interval and the duration."""
    interval, duration = scene.interval, scene.time.duration
    if interval > duration:
        allowed = f"must not exceed time.duration = {duration:g}"
        if scene.record.interval is None and (period := shortest_period(scene.pulses)):
            allowed += f": absent, it is a 200th of the period, {period:g} s"
        raise contradiction("record.interval", interval, allowed)
    if duration / interval > MOST_SAMPLES:
        allowed = f"must give at most {MOST_SAMPLES:,} samples"
        raise contradiction("record.interval", interval, allowed)


def check_fields(scene: AnyScene) -> None:
    """Raise a contradiction between the times of snapshots, of samples and the duration."""
    fields, interval, duration = scene.record.fields, scene.interval, scene.time.duration
    if fields is None:
        return
    if not interval * (1 - 1e-9) <= fields <= duration:
        span = f"the sampling interval {interval:g} s and time.duration = {duration:g}"
        raise contradiction("record.fields", fields, f"must lie between {span}")
    if duration / fields > MOST_SNAPSHOTS:
        allowed = f"must give at most {MOST_SNAPSHOTS:,} snapshots"
        raise contradiction("record.fields", fields, allowed)


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


def check_damping(table: str, law: JointLaw | Segment, scene: AnyScene) -> None:
    """Raise a contradiction of a damping ratio with Rayleigh damping."""
    if scene.damping.rayleigh is not None and law.damping_ratio is not None:
        allowed = "damping.rayleigh already sets the dashpots: give one of them"
        raise contradiction(f"{table}.damping_ratio", law.damping_ratio, allowed)


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
        most = "needs a cohesion" if cohesion is None else f"at most the cohesion {cohesion:g} Pa"
        raise contradiction(f"{table}.residual_cohesion", residual, most)


def check_fracture(table: str, law: JointLaw, stiffness: float, symbol: str) -> None:
    """Refuse a joint whose stress falls faster than it can unload (Pa/m): it would snap back."""
    if law.tensile_strength is None or law.fracture_energy is None:
        return
    least = SNAP * law.tensile_strength**2 / (2 * stiffness)
    if law.fracture_energy < least:
        digit = 10.0 ** (floor(log10(least)) - 3)
        allowed = (
            f"must exceed tensile_strength^2 / (2 {symbol}), or the joint snaps back: at least "
            f"{ceil(least / digit) * digit:.4g} J/m2"
        )
        raise contradiction(f"{table}.fracture_energy", law.fracture_energy, allowed)
