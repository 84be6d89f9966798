"""Drawn numbers, in a multiple of the unit suited to their size."""

from typing import NamedTuple

from jointwave.results.labels import QUANTITIES, label

MULTIPLES = {"G": 1e9, "M": 1e6, "k": 1e3, "": 1.0, "m": 1e-3, "µ": 1e-6, "n": 1e-9}

#: SI units of the quantities of waveforms.
UNITS = {name: label(name)["units"] for name in QUANTITIES}


class Unit(NamedTuple):
    """A multiple of an SI unit ("kPa") and its size in SI units."""

    name: str
    size: float


#: Units of waveforms on the page, by SI unit: the same for all scenes.
DRAWN = {
    "Pa": Unit("MPa", 1e6),
    "m/s": Unit("m/s", 1.0),
    "m": Unit("mm", 1e-3),
    "rad": Unit("mrad", 1e-3),
}


def in_unit(value: float, si: str) -> str:
    """Return a value with the multiple of its unit that suits it, in words."""
    unit = unit_for(si, abs(value))
    return f"{value / unit.size:.3g} {unit.name}"


def unit_for(si: str, largest: float) -> Unit:
    """Return the multiple of a unit that brings `largest` between 1 and 1000, or the unit itself
    if there is none."""
    sizes = {prefix + si: size for prefix, size in MULTIPLES.items()}
    suits = (Unit(name, size) for name, size in sizes.items() if 1 <= largest / size < 1000)
    return next(suits, Unit(si, 1.0))
