"""Plausible constants of rock, and the unit that one far from them was likely meant in."""

from collections.abc import Iterator
from typing import Any, NamedTuple

from cases.kinds import AnyScene

#: Other units in which values are often given, and their factors to SI.
Units = tuple[tuple[str, float], ...]
OF_STRESS: Units = (("GPa", 1e9), ("MPa", 1e6), ("kPa", 1e3))
OF_STIFFNESS: Units = (("GPa/m", 1e9), ("MPa/m", 1e6), ("kPa/m", 1e3))
OF_SPEED: Units = (("km/s", 1e3), ("mm/s", 1e-3))
OF_DENSITY: Units = (("g/cm3", 1e3), ("kN/m3", 1e3 / 9.81), ("g/m3", 1e-3))


class Usual(NamedTuple):
    """A quantity of rock: its unit, usual range, and the range beyond which a value is suspect."""

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
LAYER = Usual("Pa", 1e7, 3e11, 1e5, 1e17, OF_STRESS)  # S K_n, of joints that may be all but rigid
JOINT = Usual("Pa/m", 1e8, 5e12, 1e4, 1e17, OF_STIFFNESS)

OF_ROCK = {
    "density": DENSITY,
    "p_speed": SPEED,
    "s_speed": SPEED,
    "equivalent_modulus": MASS,
    "intact_modulus": INTACT,
}
OF_JOINTS = {"normal_stiffness": JOINT, "shear_stiffness": JOINT, "spacing_stiffness": LAYER}


def implausible(scene: AnyScene) -> Iterator[str]:
    """Yield a line for each constant of rock or joints that lies far outside rock's."""
    tables: dict[str, tuple[Any, dict[str, Usual]]] = {"rock": (scene.rock, OF_ROCK)}
    if hasattr(scene, "joints"):
        tables["joints"] = (scene.joints, OF_JOINTS)
    for key in ("soft_layers", "joint_sets"):
        several = getattr(scene, key, [])
        tables |= {f"{key}[{i}]": (one, OF_JOINTS) for i, one in enumerate(several)}
    for key in ("segments", "regions"):
        several = getattr(scene, key, [])
        tables |= {f"{key}[{i}]": (one, OF_ROCK | OF_JOINTS) for i, one in enumerate(several)}
    for table, (holder, known) in tables.items():
        for key, usual in known.items():
            value = getattr(holder, key, None)
            if value is not None and not usual.least <= value <= usual.most:
                side = "below" if value < usual.least else "above"
                yield (
                    f"{table}.{key} = {value:g} {usual.unit} is far {side} rock's"
                    f"{meant(value, usual)}"
                )


def meant(value: float, usual: Usual) -> str:
    """Return a value in the unit in which it would be usual for rock; empty if there is none."""
    for unit, factor in usual.others:
        if usual.low <= value * factor <= usual.high:
            return f": {value:g} {unit} is {value * factor:.4g} {usual.unit}"
    return ""
