"""Places of waveforms: one component of one quantity at one receiver.

A receiver is at y in a pillar, at (x, y) in a rock mass, in space at (x, y, z). In labels and
column headers a place is `stress@20`, `velocity_x@20.25` or `velocity_x@[20, 30]`; in text
"velocity x at [20, 30] m".
"""

import re
from typing import NamedTuple

import numpy as np
import xarray as xr

from jointwave.cases.scene_type import AnyScene
from jointwave.cases.units import UNITS
from jointwave.results.dataset import NAMES, key_of
from jointwave.results.labels import AXES, QUANTITIES, RECEIVERS
from jointwave.results.stress import stress_components

#: Components of each quantity in labels, "" if there is only one, by the number of coordinates of
#: a receiver.
COMPONENTS: dict[int, dict[str, tuple[str, ...]]] = {
    1: {
        "stress": ("",),
        "shear": ("x", "z"),
        **dict.fromkeys(("velocity", "displacement", "rotation"), AXES),
    },
    **{
        dim: {
            "stress": tuple(stress_components(dim)),
            **dict.fromkeys(("velocity", "displacement"), AXES[:dim]),
            "traction": tuple(axes),
            "gap": ("",),
            "slip": tuple(axes[1:]) if dim == 3 else ("",),
        }
        for dim, axes in NAMES["joint_axis"].items()
    },
}

_NUMBER = r"[0-9.eE+-]+"
_NEXT = rf"\s*[,\s]\s*({_NUMBER})"
_AT = rf"({_NUMBER})|\[\s*({_NUMBER}){_NEXT}(?:{_NEXT})?\s*\]"
LABEL = re.compile(rf"([A-Za-z]+)(?:_([a-z]+))?\s*@\s*(?:{_AT})(?:\s*m)?")


class Place(NamedTuple):
    """A waveform's quantity, its component ("" for the only one), and its receiver's position, m:
    (y,) in a pillar, (x, y) or (x, y, z) in a rock mass."""

    quantity: str
    component: str
    at: tuple[float, ...]

    def __str__(self) -> str:
        return f"{self.quantity}{'_' * bool(self.component)}{self.component}@{self._at()}"

    def _at(self, form: str = ".12g", comma: str = ",") -> str:
        numbers = [format(x, form) for x in self.at]
        return numbers[0] if len(numbers) == 1 else f"[{comma.join(numbers)}]"

    @property
    def named(self) -> str:
        """The quantity and its component, "shear x"."""
        return f"{self.quantity} {self.component}".rstrip()

    @property
    def receiver(self) -> str:
        """Position as text: "15 m", "[20, 30] m"."""
        return f"{self._at('g', ', ')} m"

    @property
    def words(self) -> str:
        """The place as text: "shear x at 15 m", "velocity x at [20, 30] m"."""
        return f"{self.named} at {self.receiver}"

    @property
    def heading(self) -> str:
        """The place as text with all digits, for column headers: "shear x at y = 15 m"."""
        return f"{self.named} at {'y = ' * (len(self.at) == 1)}{self._at('.12g', ', ')} m"

    @property
    def coordinates(self) -> dict[str, float]:
        """The receiver's coordinates by name, m."""
        axes = "y" if len(self.at) == 1 else AXES[: len(self.at)]
        return dict(zip(axes, self.at, strict=True))

    @property
    def key(self) -> str:
        """The key of [record] that lists its receivers."""
        return key_of(self.quantity, len(self.at))

    def is_at(self, other: "Place") -> bool:
        """Return whether it is the same waveform as another place; no component fits any."""
        of_one = self.quantity == other.quantity and self.component in ("", other.component)
        return of_one and same(self.at, other.at)

    def waveform(self, result: xr.Dataset) -> np.ndarray | None:
        """Return this waveform of a result [n] in SI; None if the result has none."""
        of_quantity = result[[self.quantity]] if self.quantity in result else xr.Dataset()
        found = waveforms(of_quantity).items()
        return next((wave for place, wave in found if self.is_at(place)), None)


def spelled(text: str) -> Place | None:
    """Return quantity, component and receiver as spelled in a label; None for other texts."""
    match = LABEL.fullmatch(text.strip())
    if match is None or match[1].lower() not in UNITS:
        return None
    try:
        at = tuple(float(one) for one in match.groups()[2:] if one is not None)
    except ValueError:
        return None
    return Place(match[1].lower(), match[2] or "", at)


def parsed(text: str) -> Place | None:
    """Return the place given by a label; None if no scene can have it."""
    place = spelled(text)
    if place is None:
        return None
    if len(place.at) == 1 and place.quantity in ("velocity", "displacement"):
        place = place._replace(component=place.component or "y")
    known = COMPONENTS[len(place.at)].get(place.quantity, ())
    return place if place.component in known else None


def waveforms(result: xr.Dataset, suffix: str = "") -> dict[Place, np.ndarray]:
    """Return every waveform [n] of a result in SI by its place, components included.

    suffix : of the variables; "_error" for the bounds on a result's own root-mean-square error [1].
    """
    found: dict[Place, np.ndarray] = {}
    for quantity in (name for name in QUANTITIES if name + suffix in result):
        positions, components = places_of(result, quantity + suffix)
        for at, values in zip(positions, result[quantity + suffix].values, strict=True):
            columns = values.reshape(-1, len(components)).T
            found |= {
                Place(quantity, c, at): column
                for c, column in zip(components, columns, strict=True)
            }
    return found


def shown(place: Place, result: xr.Dataset) -> Place:
    """Return a place for display, without its component if a result has only one."""
    alone = len(places_of(result, place.quantity)[1]) == 1
    return place._replace(component="") if alone else place


def places_of(result: xr.Dataset, quantity: str) -> tuple[list[tuple[float, ...]], list[str]]:
    """Return a quantity's receivers, m, and the names of its components ("" for the only one)."""
    found = result[quantity]
    (receivers,) = (name for name in RECEIVERS if name in found.dims)
    columns = [result[name].values.tolist() for name in RECEIVERS[receivers] if name in result]
    dims = [name for name in NAMES if name in found.dims]
    components = [str(one) for one in found[dims[0]].values] if dims else [""]
    return list(zip(*columns, strict=True)), components


def recorded(scene: AnyScene, key: str) -> list[tuple[float, ...]]:
    """Return the receivers of a key of [record], m; empty if the kind of scene has no such key."""
    return [tuple(one.tolist()) for one in scene.places.get(key, ())]


def same(one: tuple[float, ...], other: tuple[float, ...]) -> bool:
    """Return whether two receivers coincide to the digits written in files."""
    return len(one) == len(other) and bool(np.isclose(one, other, rtol=1e-9, atol=1e-9).all())
