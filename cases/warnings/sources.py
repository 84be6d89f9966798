"""Warnings about loads and waves: when they act and arrive, and conditions where they act."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from itertools import islice
from math import nan
from typing import Any

import numpy as np

from jointwave.cases.histories import Gabor, Ricker
from jointwave.cases.loads import LEAST_BLOCKS, frequency_of, highest_frequency, history_of
from jointwave.cases.material.constant_q import mechanisms_of
from jointwave.cases.material.contact_points import lever
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.schema.joint import Joints
from jointwave.cases.schema.pulse import Pulse

LEAST_LEVER = 0.75  # of contact points on a face that opens, over its half width
ONSET = 0.01  # of a load's peak: defines its beginning
LATE = 5.0  #: end of a table over the duration beyond which it was hardly cut off on purpose
STATIC = 100.0  #: more crossings of the rock per shortest period: not a wave test
ABSORBING = "quiet", "matched"  # conditions of sides with dashpots
OF_DISPERSION = 0.02  # reflected by their impedance at another frequency than the wave's
MOST_REFLECTED = 0.05  # by sides whose impedance is that of joints before they close further
LEAST_SAMPLES = 10  # per period: they miss at most 5 % of a sine's peak
LEAST_DAMPING = 1 / 80  # ratio: waves of two blocks' length decay to 1/e within 20 blocks
OF_A_PERIOD = 4.0  # the rise of a wave at its steepest, in its shortest period
OF_A_RISE = 40  # blocks that the front of a load passes while it rises


def of_sources(
    scene: AnyScene,
    *,
    crossings: float,
    block: float | None,
    speed: Callable[[Any], float],
    pressed: Mapping[str, str],
    instead: str,
    arrivals: Iterable[tuple[str, float]],
    opening: Mapping[str, Any],
    closing: Iterable[tuple[str, float, float, float]],
    steepening: Iterable[tuple[str, float, float]],
) -> Iterator[str]:
    """Warn of loads or waves that act outside the run, or not as intended.

    crossings : of the rock by a wave, per second. block : size of blocks between joints that can
    fail, m; None without. speed : of a pulse's wave, m/s. pressed : the side on which a load acts
    as a stress, by table. instead : how to let the whole load enter through such a side. arrivals :
    receivers, and arrival times of waves there, s. opening : joints that may open under bending, by
    table. closing : absorbing sides, the stress that closes joints there, Pa, and the rock's
    impedance before and under it, Pa s/m. steepening : tables of waves that close joints without
    damping, their way, m, and the slowness that they lose at their peaks, s/m.
    """
    end = scene.time.duration
    for table, pulse in scene.sources.items():
        if not pulse.amplitude:
            continue
        held = scene.sides.get(pressed.get(table, ""))
        frequency = frequency_of(pulse, end)
        if not frequency or scene.gravity is not None:  # bodies under gravity may rock slowly
            frequency = nan
        yield from _of_pulse(table, pulse, end, crossings / frequency)
        if pulse.shape == "step" and block is not None:
            yield (
                f"{table}.shape = 'step': blocks of {block:.3g} m overshoot behind its front "
                "by up to 27 %, and joints that slip, open or break do so too early: a load that "
                f"rises in {OF_A_RISE * block / speed(pulse):.3g} s (a 'triangle' of long "
                "decay, a 'table') overshoots by at most 2 %"
            )
        if held in ABSORBING:
            yield (
                f"{table}.amplitude = {pulse.amplitude:g} acts on the dashpot of "
                f"{pressed[table]} = '{held}', too, which takes half: {pulse.amplitude / 2:g} "
                f"enters; {instead}"
            )
    highest = highest_frequency(scene)
    if highest is not None and scene.rock.quality_factor is not None:
        yield from _of_quality(scene, highest)
    if highest is not None and (samples := 1 / (highest * scene.interval)) < LEAST_SAMPLES:
        yield (
            f"record.interval = {scene.interval:g} s takes {samples:.2g} samples in a period at "
            f"{highest:.4g} Hz, below which 95 % of the energy lies: it misses peaks between them; "
            f"{1 / (highest * LEAST_SAMPLES):.2g} s takes {LEAST_SAMPLES}"
        )
    if scene.gravity is None or scene.gravity.static:  # else everything falls at once
        for receiver, at in arrivals:
            if at >= end:
                yield f"record.{receiver} is reached at {at:.4g} s: {_after(end)}"
    for side, stress, before, under in closing:
        if (reflects := (under - before) / (under + before)) > MOST_REFLECTED:
            yield (
                f"{side} = '{scene.sides[side]}' has the impedance of rock in its initial stress: "
                f"joints that close under {stress:.3g} Pa reflect up to {reflects:.2g} of the wave "
                "there"
            )
    for table, way, lost in steepening:
        if highest is not None and (at := 1 / (OF_A_PERIOD * highest * lost)) < way:
            yield (
                f"{table}: joints that close, hardly damped, steepen its wave into a shock within "
                f"{at:.3g} of {way:.3g} m; behind it rigid blocks, jointed rock and implicit steps "
                "differ by 5 to 100 %: a damping_ratio of 0.1 smooths it"
            )
    levers = (line for table, joints in opening.items() for line in _of_lever(table, joints))
    yield from islice(levers, 1)


def _of_quality(scene: AnyScene, highest: float) -> Iterator[str]:
    """Warn of loads beyond the band of constant Q, and of dashpots at sides whose impedance, that
    of the rock at its reference frequency, is not the wave's; highest : frequency of the loads."""
    at, low, high = scene.rock.quality_frequencies(scene.pulses)
    own = [1 / one.time_scale for one in scene.pulses if one.time_scale] or [highest]
    if beyond := [one for one in (highest, *own) if not low <= one <= high]:
        yield (
            f"rock.quality_factor = {scene.rock.quality_factor:g} holds from {low:.4g} to "
            f"{high:.4g} Hz and rises beyond, but the load reaches {beyond[0]:.4g} Hz: give "
            "rock.quality_band"
        )
    absorb = [f"{key} = '{kind}'" for key, kind in scene.sides.items() if kind in ABSORBING]
    rock = mechanisms_of(scene, "jointed")
    assert rock is not None
    speed = 1 / float((1 / np.sqrt(rock.modulus(2j * np.pi * np.array(max(own))))).real)
    if absorb and (reflects := abs(speed - 1) / (speed + 1)) > OF_DISPERSION:
        yield (
            f"{absorb[0]} has rock's impedance at rock.reference_frequency = {at:g} Hz: waves of "
            f"{max(own):.4g} Hz are {speed:.4g} times as fast, {reflects:.2g} of them is reflected "
            "there, and as much is missing from, or added to, waves that enter"
        )


def _of_pulse(table: str, pulse: Pulse, end: float, crossings: float) -> Iterator[str]:
    """Warn of a pulse's times; crossings : of the rock by a wave per shortest period."""
    longer = f"is longer than the scene, time.duration = {end:g} s"
    if pulse.shape == "step":
        return
    if pulse.history is not None:
        yield from _of_table(table, pulse, end, crossings)
    elif pulse.rise is not None and pulse.rise > end:
        yield f"{table}.rise = {pulse.rise:g} s {longer}"
    elif pulse.period and (wavelet := _wavelet(pulse)) and wavelet.centre > end:
        yield (
            f"{table}.period = {pulse.period:g} s: the wavelet peaks at "
            f"{wavelet.centre / pulse.period:g} periods, {_after(end)}"
        )
    elif pulse.period and pulse.period > end:
        meant = f"; {pulse.period:g} Hz is {1 / pulse.period:g} s" if pulse.period > 1 else ""
        yield f"{table}.period = {pulse.period:g} s {longer}{meant}"
    elif pulse.period and STATIC < crossings < 1e3 * STATIC:
        yield (
            f"{table}.period = {pulse.period:g} s: a wave crosses the rock {crossings:.3g} times "
            f"in it; {pulse.period:g} ms is {pulse.period / 1e3:g} s"
        )


def _of_table(table: str, pulse: Pulse, end: float, crossings: float) -> Iterator[str]:
    history = pulse.history
    assert history is not None
    last, file = float(history.time[-1]), pulse.file
    peak = float(history.time[np.abs(history.stress).argmax()])
    late = peak > end
    slow = STATIC < crossings < 1e3 * STATIC
    if not history.timed and (slow or look_like_milliseconds(history.time, history.stress, end)):
        why = (
            f"the scene ends at {end:g} s"
            if late
            else f"a wave crosses the rock {crossings:.3g} times in a period of them"
        )
        yield (
            f"{table}.file = {file!r}: its times, up to {last:g} s, look like milliseconds "
            f"({why}): in seconds they are {last / 1e3:g}"
        )
    elif late:
        yield f"{table}.file = {file!r} peaks at {peak:g} s, {_after(end)}"


def _after(end: float) -> str:
    return f"after the end of the scene at time.duration = {end:g} s"


def look_like_milliseconds(time: np.ndarray, values: np.ndarray, end: float) -> bool:
    """Return whether a history peaks far after the end of a scene (s), but ends within it if its
    times are milliseconds."""
    last = time[-1]
    return bool(time[np.abs(values).argmax()] > end and LATE * end < last <= 1e3 * end)


def of_resolution(gives: str, count: float, what: str, remedy: str = "") -> Iterator[str]:
    """Warn of too few blocks or nodes per wavelength."""
    if count < LEAST_BLOCKS:
        yield f"{gives} {count:.3g} {what}; at least {LEAST_BLOCKS:g} resolve it{remedy}"


def of_dashpot(table: str, ratio: float, length: str, eta: float) -> str:
    """Return the warning of a joint whose dashpot depends on a length that is none of its own."""
    return (
        f"{table}.damping_ratio = {ratio:g} takes {length} for the block on this joint: its "
        f"dashpot, now {eta:.3g} s times its stiffness, changes with that length (viscosity not)"
    )


def onset(pulse: Pulse) -> float:
    """Return the time when a load or wave first reaches a hundredth of its peak, s."""
    history = pulse.history
    if wavelet := _wavelet(pulse):
        time = np.linspace(0.0, wavelet.centre, 1000)
        values = wavelet.value(time)
    elif history is not None:
        time, values = history.time, history.stress
    else:
        return 0.0
    felt = np.abs(values) >= ONSET * np.abs(values).max()
    first = int(felt.argmax())
    return float(time[max(first - 1, 0)])


def _wavelet(pulse: Pulse) -> Ricker | Gabor | None:
    """Return the history of a pulse with a gradual onset; None for others."""
    found = history_of(pulse, 1.0)
    return found if isinstance(found, Ricker | Gabor) else None


def _of_lever(table: str, joints: Joints) -> Iterator[str]:
    """Warn of contact points far from the edges of a face that may open under bending."""
    rule, count = joints.point_rule, joints.contact_points
    if (found := lever(rule, count)) < LEAST_LEVER:
        thicker = f"{1 / found:.3g} times the thickness" if found else "more than any thickness"
        yield (
            f"{table}.point_rule = {rule!r} of {count or 2} points: a face of rigid blocks that "
            f"opens bears at {found:.3g} of its half width, so that what stands by its edges needs "
            f"{thicker}; 'vertices' bear at its edges"
        )
