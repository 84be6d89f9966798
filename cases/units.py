"""Units of measured quantities, and their spelling in column headers."""

import re
from math import pi

_SCALES = {"": 1.0, "k": 1e3, "M": 1e6, "G": 1e9, "c": 1e-2, "m": 1e-3, "n": 1e-9}
_SCALES |= dict.fromkeys("uµμ", 1e-6)  # as typed, the micro sign, and the Greek letter


def _units(scales: str, *names: str) -> dict[str, float]:
    return {scale + name: _SCALES[scale] for name in names for scale in ["", *scales]}


TIME = _units("muµμn", "s") | {"sec": 1.0, "msec": 1e-3}
TIME |= {"seconds": 1.0, "milliseconds": 1e-3, "microseconds": 1e-6, "nanoseconds": 1e-9}
ACCELERATION = _units("cmuµμn", "m/s2", "m/s^2", "m/s²") | {"g": 9.80665, "Gal": 1e-2, "gal": 1e-2}

#: By quantity: its units, each with its factor to SI.
UNITS = {
    **dict.fromkeys(("stress", "shear", "traction"), _units("kMG", "Pa")),
    **dict.fromkeys(("displacement", "gap", "slip"), _units("cmuµμn", "m")),
    "force": _units("kM", "N/m"),  # of a load in the plane
    "velocity": _units("cmuµμn", "m/s"),
    "acceleration": ACCELERATION,
    "rotation": _units("muµμ", "rad") | {"deg": pi / 180},
}
FORCE = _units("kM", "N")  # of a load in space
EVERY = (TIME, FORCE, *UNITS.values())
KNOWN = {unit: factor for units in EVERY for unit, factor in units.items()}


def units_of(quantity: str, in_space: bool) -> dict[str, float]:
    """Return the units of a load's quantity with their factors to SI, the SI unit first."""
    if quantity == "force" and in_space:
        return FORCE
    return UNITS[quantity.removeprefix("incident-")]


def _any_of(units: list[str]) -> str:
    return "|".join(map(re.escape, sorted(units, key=len, reverse=True)))


#: Units that may follow a blank or _: no single SI unit, which may be part of a name.
_AFTER_BLANK = [one for one, factor in KNOWN.items() if factor != 1 or "/" in one]
#: A unit without brackets; `8 ms` is a time, and N is the north.
_SEPARATED = re.compile(
    rf"(.*?[^\s,/])(?<!\sin)(?:_|(?<!\d)\s)({_any_of(_AFTER_BLANK)})"
    rf"|(.*?\S)(?:\s*[,/]\s*|\sin\s)({_any_of([one for one in KNOWN if one != 'N'])})"
)


def split_unit(text: str) -> tuple[str, str]:
    """Return name and unit of `name [unit]`, `name (unit)`, `name, unit`, `name / unit` or
    `name_unit`, unit "" without one; without brackets the unit must be a known one."""
    text = text.strip()
    for opening, closing in ("[]", "()"):
        if text.endswith(closing) and opening in text:
            name, _, unit = text[:-1].rpartition(opening)
            if not name.rstrip().endswith("@"):  # else a receiver's place, `gap@[20,30]`
                return name.strip(), unit.strip()
    found = _SEPARATED.fullmatch(text)
    return (found[1] or found[3], found[2] or found[4]) if found else (text, "")
