"""Plausible values of a scene's quantities, and the likely unit of values far outside them."""

from collections.abc import Iterator
from math import atan, degrees, inf, radians
from typing import Any, NamedTuple

from jointwave.cases.scene_type import AnyScene
from jointwave.cases.schema.joint import SoftLayer
from jointwave.cases.schema.law_parts import under

#: Other common units and their factors to SI.
Units = tuple[tuple[str, float], ...]
OF_STRESS: Units = (("GPa", 1e9), ("MPa", 1e6), ("kPa", 1e3))
OF_STIFFNESS: Units = (("GPa/m", 1e9), ("MPa/m", 1e6), ("kPa/m", 1e3))
OF_SPEED: Units = (("km/s", 1e3), ("mm/s", 1e-3))
OF_LENGTH: Units = (("mm", 1e-3), ("um", 1e-6))
OF_DENSITY: Units = (("g/cm3", 1e3), ("kN/m3", 1e3 / 9.81), ("g/m3", 1e-3))


class Usual(NamedTuple):
    """A rock quantity: unit, usual range, range beyond which a value is suspect, other units."""

    unit: str
    low: float
    high: float
    least: float
    most: float
    others: Units


DENSITY = Usual("kg/m3", 1e3, 6e3, 500.0, 2e4, OF_DENSITY)
SPEED = Usual("m/s", 50.0, 9e3, 20.0, 2e4, OF_SPEED)
INTACT = Usual("Pa", 1e9, 3e11, 1e8, 3e12, OF_STRESS)
MASS = Usual("Pa", 1e8, 3e11, 1e7, 3e12, OF_STRESS)
LAYER = Usual("Pa", 1e7, 3e11, 1e5, 1e17, OF_STRESS)  # S K_n; joints may be almost rigid
STRENGTH = Usual("Pa", 1e4, 3e7, 1e3, inf, OF_STRESS)
CLOSURE = Usual("m", 1e-6, 5e-3, 1e-8, 5e-2, OF_LENGTH)
LENGTH = Usual("m", 1e-2, 1e3, 1e-4, 4e4, OF_LENGTH)
ACTING = Usual("Pa", 1e4, 3e8, 1e3, 1e12, OF_STRESS)
MOTION = Usual("m/s", 1e-4, 3.0, 0.0, 30.0, OF_SPEED)
JOINT = Usual("Pa/m", 1e8, 5e12, 1e4, 1e17, OF_STIFFNESS)

OF_ROCK = {
    "density": DENSITY,
    "p_speed": SPEED,
    "s_speed": SPEED,
    "equivalent_modulus": MASS,
    "intact_modulus": INTACT,
}
OF_JOINTS = {
    "normal_stiffness": JOINT,
    "shear_stiffness": JOINT,
    "spacing_stiffness": LAYER,
    "cohesion": STRENGTH,
    "residual_cohesion": STRENGTH,
    "tensile_strength": STRENGTH,
    "maximum_closure": CLOSURE,
}
OF_ALL = OF_ROCK | OF_JOINTS
POISSON = ("equivalent_poisson", "intact_poisson")
OF_PILLAR = {"length": LENGTH, "side": LENGTH, "block": LENGTH}
OF_PRESTRESS = {"normal": ACTING, "xx": ACTING, "yy": ACTING, "zz": ACTING}
#: Angles (degrees) below these are probably radians, or friction coefficients.
LEAST_ANGLE = {"friction_angle": 2.0, "dynamic_friction_angle": 1.0, "dilation_angle": 0.5}
OVERDAMPED = 1.0  # damping ratio


def implausible(scene: AnyScene) -> Iterator[str]:
    """Yield a line for each value that is implausible for rock or probably in another unit."""
    tables: dict[str, tuple[Any, dict[str, Usual]]] = {"rock": (scene.rock, OF_ROCK)}
    tables |= {key: (law, OF_JOINTS) for key, law in scene.laws.items()}
    for table, known in (("pillar", OF_PILLAR), ("segments", OF_ALL), ("regions", OF_ALL)):
        tables |= {key: (one, known) for key, one in scene.entries(table)}
    for table, (holder, known) in tables.items():
        for key, usual in known.items():
            yield from of_value(f"{table}.{key}", getattr(holder, key, None), usual)
        for key in POISSON:
            if (value := getattr(holder, key, None)) and value < 0:
                yield f"{table}.{key} = {value:g} is negative, which no known rock is"
    for table, law in scene.laws.items():
        yield from _of_law(table, law)
        rest = under(law, scene.joints) if isinstance(law, SoftLayer) else law  # type: ignore[union-attr]
        if law.friction_angle is not None and rest.tension is rest.tensile_strength is None:
            yield (
                f"{table}.friction_angle without {table}.tension: the joint carries any tension; "
                "say tension = false, or true where that is meant"
            )
    yield from _of_sources(scene)
    for key in OF_PRESTRESS if scene.prestress is not None else ():
        value = getattr(scene.prestress, key, None) or 0.0
        if value < 0:
            yield f"prestress.{key} = {value:g} Pa is tension: compression is positive"
        yield from of_value(f"prestress.{key}", abs(value), OF_PRESTRESS[key])


def of_value(key: str, value: float | None, usual: Usual, others: str = "rock's") -> Iterator[str]:
    """Yield a line if a nonzero value is outside the limits of plausibility."""
    if value and not usual.least <= value <= usual.most:
        side = "below" if value < usual.least else "above"
        yield f"{key} = {value:g} {usual.unit} is far {side} {others}{meant(value, usual)}"


def _of_law(table: str, law: Any) -> Iterator[str]:
    """Yield lines about angles and ratios that are probably in another unit."""
    for key, least in LEAST_ANGLE.items():
        if (value := getattr(law, key)) and value < least:
            yield (
                f"{table}.{key} = {value:g} degrees: {value:g} rad is {degrees(value):.4g} degrees"
                f", and a coefficient of {value:g} is {degrees(atan(value)):.4g} degrees"
            )
    yield from of_dip(f"{table}.dip", getattr(law, "dip", 0.0))
    if (ratio := law.damping_ratio) and ratio > OVERDAMPED:
        yield f"{table}.damping_ratio = {ratio:g} is overdamped: {ratio:g} % is {ratio / 100:g}"


def of_dip(key: str, dip: float) -> Iterator[str]:
    """Yield a line if a dip is probably in radians: small, and no multiple of a quarter degree."""
    if 0 < abs(dip) <= radians(90.01) and dip % 0.25:
        yield f"{key} = {dip:g} degrees: {dip:g} rad is {degrees(dip):.4g} degrees"


def _of_sources(scene: AnyScene) -> Iterator[str]:
    """Yield lines about loads and waves in other units; a table counts by its peak."""
    usual = {"stress": ACTING, "incident-stress": ACTING, "velocity": MOTION}
    for table, one in scene.sources.items():
        peak = 1.0 if one.history is None else float(abs(one.history.stress).max())
        if one.quantity in usual:
            whose = f"{table}.amplitude" if one.file is None else f"the peak of {table}"
            acts = abs(one.amplitude) * peak
            yield from of_value(whose, acts, usual[one.quantity], "that of a load on rock")


def meant(value: float, usual: Usual) -> str:
    """Return a value in the other unit in which it would be usual for rock, or ""."""
    for unit, factor in usual.others:
        if usual.low <= value * factor <= usual.high:
            return f": {value:g} {unit} is {value * factor:.4g} {usual.unit}"
    return ""
