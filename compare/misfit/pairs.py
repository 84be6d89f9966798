"""Distances between the solutions of a scene, pair by pair."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cache
from math import nan
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from jointwave.cases.scene_type import AnyScene
from jointwave.compare.engines import label_of, solver, solvers
from jointwave.compare.misfit.alignment import AlignedCurve, distance_at, motions, static_level
from jointwave.compare.misfit.metrics import Distance, distance, motion, pairings, rms
from jointwave.compare.misfit.places import Place, shown, waveforms
from jointwave.compare.misfit.ranking import kind_of
from jointwave.compare.misfit.weight import CARRIES, FAINT, weigh
from jointwave.compare.solvers.record import Kind
from jointwave.results.labels import UNITS


class Pair(NamedTuple):
    """A result, its reference, and the meaning of their distance."""

    one: str
    other: str
    kind: str


GIVEN = "given curves"  # external data
A_COMPARISON = "a comparison, of `compare`"
UNLIKELY = 100.0  # peak ratio of a curve without a unit that suggests another unit


@cache
def pairs() -> tuple[Pair, ...]:
    """Return the pairs whose distance is measured, by its meaning, then as in the registry."""
    every = solvers()
    place = {one.name: i for i, one in enumerate(every)}
    found = [
        (kind, place[one], place[other.name], Pair(one, other.name, kind.words))
        for other in every
        for kind, ones in (other.distances or {}).items()
        for one in ones
    ]
    return tuple(pair for *_, pair in sorted(found))


def meaning(pair: Pair) -> str:
    """Return the causes of a pair's distance; "" if one is an external curve."""
    if pair.kind == GIVEN:
        return ""
    of_kinds = (solver(pair.other).distances or {}).items()
    kind, cause = next(
        ((k, ones[pair.one]) for k, ones in of_kinds if pair.one in ones), (None, "")
    )
    return cause if kind is None or kind.words == pair.kind else f"another model; {cause}"


class Row(NamedTuple):
    """The distance of one pair at one receiver.

    place : with the component, if there are several. floor : relative error of the second solution
    itself; a misfit below ten times this is not resolved. faint : too weak to decide a misfit.
    of_all : whether the misfit is relative to all motion of the quantity there.
    """

    pair: Pair
    place: Place
    distance: Distance
    floor: float = 0.0
    faint: bool = False
    of_all: bool = False

    @property
    def quantity(self) -> str:
        """The quantity with its component, "shear x"."""
        return self.place.named

    @property
    def facts(self) -> dict[str, Any]:
        """Pair, place and distances, machine-readable."""
        where = {"quantity": self.quantity, **self.place.coordinates}
        weight = {"floor": self.floor, "faint": self.faint, "of_all": self.of_all}
        return {**self.pair._asdict(), **where, **self.distance._asdict(), **weight}

    @property
    def solutions(self) -> str:
        """The names of both solutions, "one ~ other"."""
        return f"{self.pair.one} ~ {self.pair.other}"


@dataclass
class Comparison:
    """One variant of a scene, its solutions, and why others do not apply.

    scene : of either kind. results : by name. reasons : by name, for solutions that do not apply or
    `failed`. rows : the distances. besides : external curves, one entry per file.
    """

    scene: Any
    results: dict[str, xr.Dataset] = field(default_factory=dict)
    reasons: dict[str, str] = field(default_factory=dict)
    rows: list[Row] = field(default_factory=list)
    besides: list[AlignedCurve] = field(default_factory=list)
    failed: list[str] = field(default_factory=list)


def measure(
    results: dict[str, xr.Dataset], spectral: bool = False, scene: "AnyScene | None" = None
) -> list[Row]:
    """Return the distances of every available pair, for every waveform that both have.

    Envelope and phase misfits are computed for stress, shear, velocity and rotation, if not faint.
    scene : in which two solvers may resolve different models; None: as their records say.
    """
    rows = []
    for pair in pairs():
        if pair.one not in results or pair.other not in results:
            continue
        if scene is not None and pair.kind == Kind.NUMERICAL.words:
            pair = pair._replace(kind=kind_of(pair.one, pair.other, scene).words)
        one, other = results[pair.one], results[pair.other]
        dt = float(other.time[1] - other.time[0])
        for p in pairings(one, other):
            spectra = spectral and not p.faint and p.place.quantity != "displacement"
            found = distance(p.one, p.other, dt, spectra)._replace(misfit=p.misfit)
            rows.append(Row(pair, p.place, found, p.floor, p.faint, p.of_all))
    return rows


def measure_curves(
    beside: AlignedCurve, results: dict[str, xr.Dataset], spectral: bool = False
) -> list[Row]:
    """Return the distances of a file's curves from every solution that has a waveform there. A row
    is faint if the solution is not excited there, unless the curve moves enough to decide; its
    distances are NaN if neither moves by 1 % of the solution's peak before the curve ends."""
    rows, time, own = [], beside.time, beside.curves.time
    for name, result in results.items():
        moved = {place: rms(wave) for place, wave in waveforms(motion(result)).items()}
        weight = weigh([*moved], np.array([*moved.values()]))
        still = {
            place: least * norm
            for place, norm, least, excited in zip(moved, *weight, strict=True)
            if not excited
        }
        for place, values, ours in motions(beside.curves, result):
            waves = np.interp(time, own, values), np.interp(time, result.time.values, ours)
            found, pair = distance_at(time, *waves, spectral), Pair(beside.curves.name, name, GIVEN)
            faint = rms(waves[0] - waves[1]) < still.get(place, 0.0)
            if np.abs(waves).max() < FAINT * np.abs(ours).max():
                found, faint = Distance(nan, nan, nan, nan), True
            rows.append(Row(pair, shown(place, result), found, faint=faint))
    return rows


def chaos(results: dict[str, xr.Dataset]) -> Iterator[str]:
    """Yield from when on the motion of rattling blocks is chaotic, if an exact chain knows it."""
    for name, result in results.items():
        if "events" in result.attrs and "known_until" in result.attrs:
            yield (
                f"blocks rattle chaotically: from {result.attrs['known_until']:.4g} s on "
                f"{label_of(name)} is not known, and engines differ by any amount: compare them "
                "up to then (time.duration), or with dashpots (joints.damping_ratio)"
            )


def unit_doubts(found: Comparison) -> Iterator[str]:
    """Yield external curves without a unit whose size differs from the first solution's, and
    stresses that begin without the scene's static stress."""
    first = next(iter(found.results), "")
    for beside in found.besides:
        for place, values in beside.curves.waveforms.items() if first else ():
            held = static_level(place, found.results[first])
            if place.quantity in UNITS[0] and abs(held) > max(
                2 * abs(values[0]), CARRIES * abs(values).max()
            ):
                yield (
                    f"{beside.curves.file}: {place} begins at {values[0]:.3g} Pa, the scene at "
                    f"{held:.3g} Pa: stress is total, with what is there at rest"
                )
        pair = Pair(beside.curves.name, first, GIVEN)
        for row in (one for one in found.rows if one.pair == pair):
            bare = next(filter(row.place.is_at, beside.curves.bare), None)
            ratio = row.distance.peak_ratio
            if bare and ratio > 0 and not 1 / UNLIKELY < ratio < UNLIKELY:
                yield (
                    f"{beside.curves.file}: {bare} has no unit, so it is read in SI, and its peak "
                    f"is {ratio:.1e} times that of {label_of(first)}; `{bare} [UNIT]` gives a unit"
                )
