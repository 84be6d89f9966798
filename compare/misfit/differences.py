"""Differences of two results in peaks and static state, besides those of waveforms.

Peak particle velocity is the largest length of the velocity vector over time; peak stress the
largest principal stress, in magnitude, or in a section of a pillar the length of its traction. Both
are of the motion minus its static state, at the samples, over the components of both results.
"""

from math import inf, nan
from typing import NamedTuple

import numpy as np
import xarray as xr

from jointwave.compare.misfit.metrics import Worst, pairings, shared_waveforms, static_state, worst
from jointwave.compare.misfit.places import Place, shown
from jointwave.compare.misfit.weight import FAINT
from jointwave.results.labels import PEAKS, QUANTITIES, UNITS
from jointwave.results.stress import stress_components, tensors

Position = tuple[float, ...]


class PeakDifference(NamedTuple):
    """|peak / peak of the reference - 1|: mean over the receivers, largest value, and its receiver.

    Receivers where the reference has less than 1 % of the largest peak do not count.
    """

    mean: float
    worst: float
    at: Position


def peak_differences(one: xr.Dataset, other: xr.Dataset) -> dict[str, PeakDifference]:
    """Return the differences of two results in "PPV" and "peak stress", for peaks that both have;
    the second is the reference."""
    found, shared = {}, pairings(one, other)
    for name, quantities in PEAKS.items():
        there: dict[Position, list[Worst]] = {}
        for pair in (p for p in shared if p.place.quantity in quantities):
            there.setdefault(pair.place.at, []).append(pair)
        peaks = {
            at: [
                _peak({p.place.component: getattr(p, side) for p in some})
                for side in ("one", "other")
            ]
            for at, some in there.items()
        }
        least = FAINT * max((theirs for _, theirs in peaks.values()), default=0.0)
        off = {at: abs(a / b - 1) for at, (a, b) in peaks.items() if b > 0 and b >= least}
        if off:
            at = max(off, key=lambda at: off[at])
            found[name] = PeakDifference(sum(off.values()) / len(off), off[at], at)
    return found


def distance_of(what: str, one: xr.Dataset, other: xr.Dataset) -> Worst:
    """Return the distance of two results that a bound in [expect] applies to.

    what : "" for the worst waveform, a quantity for its worst waveform, "PPV" or "peak stress" for
    the receiver whose peaks differ most, with the floor of the worst waveform of its quantities.
    NaN if the results share no such waveform.
    """
    quantities = PEAKS.get(what, (what,) if what else QUANTITIES)
    if what and not any(p.quantity in quantities for p, *_ in shared_waveforms(one, other)):
        return Worst(nan)
    found = worst(one, other, quantities)
    if what not in PEAKS or found.place is None:
        return found
    peak = peak_differences(one, other).get(what)
    if peak is None:  # the reference is at rest, the other is not
        return Worst(inf, found.place)
    return Worst(peak.worst, Place(what, "", peak.at), found.floor)


def _peak(components: dict[str, np.ndarray]) -> float:
    """Return the largest length of a vector or principal value of a tensor (absent means 0)."""
    if components.keys() <= (names := stress_components(3)).keys():
        absent = np.zeros_like(next(iter(components.values())))
        stress = np.stack([components.get(name, absent) for name in names], axis=-1)
        return float(np.abs(np.linalg.eigvalsh(tensors(stress))).max())
    return float(np.sqrt(sum(wave**2 for wave in components.values())).max())


def static_difference(one: xr.Dataset, other: xr.Dataset) -> Worst:
    """Return the largest difference of two static states over the largest static stress of the
    reference, which comes second; 0 without a static state."""
    held = [
        (place, float(a[0]), float(b[0]))
        for place, a, b in shared_waveforms(static_state(one), static_state(other))
        if place.quantity in UNITS[0]
    ]
    largest = max((abs(b) for *_, b in held), default=0.0)
    found = [Worst(abs(a - b) / largest, shown(place, one)) for place, a, b in held if largest > 0]
    return max(found, key=lambda w: w.misfit, default=Worst(0.0))
