"""Warnings of likely mistakes in a scene, one line each.

No scene is refused: unusual values may be intended. `--strict` makes each line an error.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from math import hypot, nan, sqrt
from typing import TYPE_CHECKING

import numpy as np

from jointwave.cases.effects import bends, is_spatial
from jointwave.cases.histories import Gabor, Ricker, Sine, periodic
from jointwave.cases.material.calibrate import Properties, calibrate
from jointwave.cases.material.contact_points import lever
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.schema.plausible import implausible
from jointwave.cases.schema.scene import Scene
from jointwave.cases.spectrum import LEAST_BLOCKS, ShortestWave, shortest_wave

if TYPE_CHECKING:
    from jointwave.cases.schema.joint import Joints
    from jointwave.cases.schema.pulse import Pulse

MOST_REFLECTED = 0.01  # by a quiet end on a rigid block, of the load's highest frequency
SHORTENED = 1.5  # a step shortened by less than this factor is not reported
ON_JOINT = 1e-9  # of the pillar's length, and of a block: rounding of a receiver's place
LEAST_LEVER = 0.75  # of contact points where a face opens, over half its width
ONSET = 0.01  # of a load's peak: defines its beginning
#: Of the duration: the end of a table that no one cut off there.
LATE = 5.0
#: Crossings of the pillar in a period of the load's highest frequency that no wave test has.
STATIC = 100.0

OF_A_RISE = 40  # blocks that the front of a load passes while it rises

Rule = Callable[[Scene, Properties, ShortestWave | None], Iterator[str]]


def warnings(scene: AnyScene) -> list[str]:
    """Return warnings of probable mistakes in a scene, one line each."""
    if not isinstance(scene, Scene):
        from jointwave.cases.plane.warnings import warnings_in_plane

        return warnings_in_plane(scene)
    p = calibrate(scene)
    wave = shortest_wave(scene, p)
    found = [line for rule in RULES for line in rule(scene, p, wave)]
    return [*implausible(scene), *found, *of_local_damping(scene, wave is not None)]


def of_local_damping(scene: AnyScene, acts: bool) -> Iterator[str]:
    """Warn of local damping where a load or wave acts."""
    if scene.damping.local and acts:
        yield (
            "damping.local distorts waves: it is meant for static states, not for a scene with a "
            "load"
        )


def _of_poisson(scene: Scene, p: Properties, wave: ShortestWave | None) -> Iterator[str]:
    rock = scene.rock
    if rock.p_speed and p.poisson < 0:
        yield (
            f"rock.p_speed = {rock.p_speed:g} below sqrt(2) rock.s_speed = {rock.s_speed:g} m/s "
            f"gives a negative Poisson's ratio, {p.poisson:.3g}"
        )
    given = rock.equivalent_modulus or rock.p_speed
    if given and rock.intact_modulus is None and "intact_poisson" in rock.model_fields_set:
        poisson = rock.intact_poisson
        yield f"rock.intact_poisson = {poisson:g} is not used: it needs rock.intact_modulus"
    for key in ("equivalent_poisson", "intact_poisson"):
        value = getattr(rock, key)
        if value is not None and value < 0:
            yield f"rock.{key} = {value:g} is negative, which no known rock is"


def _of_times(scene: Scene, p: Properties, wave: ShortestWave | None) -> Iterator[str]:
    if wave is not None:
        crossings = p.bar_speed / (wave.frequency * scene.pillar.length)
        yield from of_pulse("load", scene.load, scene.time.duration, crossings)


def of_pulse(table: str, pulse: Pulse, end: float, crossings: float = nan) -> Iterator[str]:
    """Say where a load or wave acts outside the run, or its table is not in seconds.

    table : of the scene that holds it. end : of the run, s. crossings : of the pillar by a wave in
    a period of the load's highest frequency.
    """
    if pulse.shape == "step":
        return
    if pulse.history is not None:
        yield from _of_table(table, pulse, end, crossings)
    elif pulse.rise is not None and pulse.rise > end:
        yield (
            f"{table}.rise = {pulse.rise:g} s is longer than the scene, time.duration = {end:g} s"
        )
    elif pulse.period and (wavelet := _wavelet(pulse)) and wavelet.centre > end:
        yield (
            f"{table}.period = {pulse.period:g} s: the wavelet peaks at "
            f"{wavelet.centre / pulse.period:g} periods, after the end of the scene at "
            f"time.duration = {end:g} s"
        )
    elif pulse.period and pulse.period > end:
        meant = f"; {pulse.period:g} Hz is {1 / pulse.period:g} s" if pulse.period > 1 else ""
        yield (
            f"{table}.period = {pulse.period:g} s is longer than the scene, time.duration = "
            f"{end:g} s{meant}"
        )
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
    if not pulse.timed and (slow or look_like_milliseconds(history.time, history.stress, end)):
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
        yield (
            f"{table}.file = {file!r} peaks at {peak:g} s, after the end of the scene at "
            f"time.duration = {end:g} s"
        )


def look_like_milliseconds(time: np.ndarray, values: np.ndarray, end: float) -> bool:
    """Return whether a history peaks far after the end of a scene (s), and with its times as
    milliseconds would lie within it."""
    last = time[-1]
    return bool(time[np.abs(values).argmax()] > end and LATE * end < last <= 1e3 * end)


def _of_half_a_load(scene: Scene, p: Properties, wave: ShortestWave | None) -> Iterator[str]:
    """Say where a dashpot takes half of a load."""
    load, start = scene.load, scene.ends.start
    if load.quantity == "stress" and load.amplitude and start in ("quiet", "matched"):
        yield (
            f"load.amplitude = {load.amplitude:g} acts on the dashpot of ends.start = '{start}', "
            f"too, which takes half: {load.amplitude / 2:g} enters; load.quantity = "
            "'incident-stress' is the stress that enters"
        )


def _of_wavelength(scene: Scene, p: Properties, wave: ShortestWave | None) -> Iterator[str]:
    if wave is None or wave.blocks >= LEAST_BLOCKS:
        return
    block = f"pillar.block = {p.spacing:g} m"
    if len(p.each) > 1:
        block = f"a block of {wave.speed / (wave.frequency * wave.blocks):g} m"
    where = f"at {wave.frequency:.4g} Hz, below which 95 % of the load's energy lies"
    if wave.frequency >= wave.cut_off:
        yield (
            f"{block}: rigid blocks transmit nothing above {wave.cut_off:.4g} "
            f"Hz; the load reaches {wave.frequency:.4g} Hz, below which 95 % of its energy lies"
        )
    else:
        yield (
            f"{block} gives {wave.blocks:.3g} blocks per wavelength {where}; "
            f"at least {LEAST_BLOCKS:g} resolve it"
        )
    count = scene.numerics.continuum.elements_per_block
    if count is not None and count * wave.blocks < LEAST_BLOCKS:
        yield (
            f"numerics.continuum.elements_per_block = {count} gives {count * wave.blocks:.3g} "
            f"elements per wavelength {where}; at least {LEAST_BLOCKS:g} resolve it"
        )


def _of_step(scene: Scene, p: Properties, wave: ShortestWave | None) -> Iterator[str]:
    """Say where samples are closer than the steps that rigid blocks would take."""
    interval, coarse = scene.interval, wave is not None and wave.blocks < LEAST_BLOCKS
    if coarse and scene.record.interval is None:
        return  # a 200th of a period that the blocks do not resolve, which is said already
    wanted = scene.numerics.dem.step_fraction * _least_critical_step(scene, p)
    if interval * SHORTENED < wanted and scene.numerics.dem.step_fraction <= 1:
        whose = "" if scene.record.interval else ", a 200th of the period,"
        yield (
            f"record.interval = {interval:.4g} s{whose} shortens the step of rigid blocks, "
            f"{wanted:.4g} s by numerics.dem.step_fraction"
        )


def _of_a_jump(scene: Scene, p: Properties, wave: ShortestWave | None) -> Iterator[str]:
    """Warn of a step load on joints that can fail: behind its front a chain of blocks overshoots by
    23 to 27 % (Airy's function), behind a rise over 40 blocks by at most 2 % up to 200 blocks on.
    """
    if scene.load.amplitude and (bool(p.given) or not p.tension.all()):
        speed = p.shear_speed if scene.load.is_across else p.bar_speed
        yield from of_a_jump("load", scene.load, scene.pillar.block, speed)


def of_a_jump(table: str, pulse: Pulse, block: float, speed: float) -> Iterator[str]:
    """Say what a step does to joints that can fail, and the rise that blocks (m) need of waves of
    this speed (m/s). table : of the scene that holds it."""
    if pulse.shape == "step":
        yield (
            f"{table}.shape = 'step': blocks of {block:.3g} m overshoot behind its front by up to "
            "27 %, and joints that slip, open or break do so too early: a load that rises in "
            f"{OF_A_RISE * block / speed:.3g} s (a 'triangle' of long decay, a 'table') overshoots "
            "by at most 2 %"
        )


def _least_critical_step(scene: Scene, p: Properties) -> float:
    """Return a critical step (s) of the row of blocks that no motion of it falls short of.

    From bounds on its largest frequency (Gershgorin): of axial motion 4 K'_n A / m, of motion in
    space twice the larger of those of the faces' springs in translation and in rotation. Where a
    block is joined to a wall, whose spring counts once, their mean takes the place of K'. With
    dashpots 2 / omega (sqrt(1 + (omega eta)^2) - omega eta), as leapfrog's that extrapolates rates.
    """
    normal, shear = float(p.stiffness.max()), float(p.shear_stiffness.max())
    for kind, rock in ((scene.ends.start, p.at_start), (scene.ends.end, p.at_end)):
        if kind == "fixed":
            normal = max(normal, (rock.wall_stiffness + 2 * normal) / 4)
            shear = max(shear, (rock.wall_shear_stiffness + 2 * shear) / 4)
    normal, shear = normal * p.area, shear * p.area
    square = 4 * normal / (p.block_mass if p.masses is None else float(p.masses.min()))
    if is_spatial(scene):
        turning = shear * p.spacing**2 / 4 + normal * p.side**2 / 4
        twisting = shear * p.side**2 / 2
        square = 2 * max(
            square,
            4 * shear / p.block_mass,
            4 * turning / p.inertia_across,
            4 * twisting / p.inertia_along,
        )
    omega, times = sqrt(square), p.joint_time_constant
    ratio = 0.0 if times is None else omega * float(times.max())
    return 2 / (omega * (hypot(1, ratio) + ratio))


def _of_arrivals(scene: Scene, p: Properties, wave: ShortestWave | None) -> Iterator[str]:
    """Say which receivers the wave does not reach before the end of the scene."""
    falls = scene.gravity is not None and not scene.gravity.static
    if wave is None or falls:
        return
    begin, end, speed = onset(scene.load), scene.time.duration, _fastest(scene, p)
    for key in ("stress", "velocity"):
        for y in getattr(scene.record, key):
            way = y / speed if p.is_uniform else p.travel_time(y)
            reached = begin + way
            if reached >= end:
                yield (
                    f"record.{key} = {y:g} m is reached at {reached:.4g} s, at "
                    f"{y / way if way else speed:.4g} m/s: after the end of the scene at "
                    f"time.duration = {end:g} s"
                )


def _fastest(scene: Scene, p: Properties) -> float:
    """Return the speed (m/s) of the fastest wave that the load drives.

    Bending runs ahead of shear, up to the speed of the bar (Timoshenko 1921).
    """
    load = scene.load
    shear_alone = load.is_across and not load.direction[1] and scene.motion.rotation == "none"
    twist = load.arm is not None and not load.is_across
    return p.shear_speed if shear_alone or twist else p.bar_speed


def onset(pulse: Pulse) -> float:
    """Return when a load or wave first reaches a hundredth of its peak, s."""
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
    """Return a pulse with a gradual onset; None for others."""
    if pulse.shape not in ("ricker", "gabor") or pulse.period is None:
        return None
    found = periodic(pulse.shape, 1.0, pulse.period, pulse.cycles)
    assert not isinstance(found, Sine)
    return found


def _of_quiet_ends(scene: Scene, p: Properties, wave: ShortestWave | None) -> Iterator[str]:
    """Warn of the reflection by a dashpot on a whole block; scenes with a source are exempt."""
    if wave is None or scene.source is not None or wave.reflection <= MOST_REFLECTED:
        return
    for key in ("start", "end"):
        if getattr(scene.ends, key) == "quiet":
            yield (
                f"ends.{key} = 'quiet' reflects {wave.reflection:.2g} of the wave at "
                f"{wave.frequency:.4g} Hz from rigid blocks; 'matched' {wave.reflection**2:.1g}"
            )


def _of_receivers_at_joints(
    scene: Scene, p: Properties, wave: ShortestWave | None
) -> Iterator[str]:
    """Warn of velocities at soft layers, across which they jump."""
    for y in scene.record.velocity:
        for layer in scene.soft_layers:
            where, away = f"record.velocity = {y:g} m", abs(y - layer.y)
            if away <= ON_JOINT * scene.pillar.length:
                yield f"{where} lies on a soft layer: it is the mean of both sides"
            elif away < (0.5 - ON_JOINT) * p.spacing:
                yield (
                    f"{where} lies within half a block of the soft layer at {layer.y:g} m: rigid "
                    "blocks interpolate across it, between their centres"
                )


def _of_contact_points(scene: Scene, p: Properties, wave: ShortestWave | None) -> Iterator[str]:
    breaks = any(one.tensile_strength is not None for one in (scene.joints, *scene.layers))
    if bends(scene) and (breaks or not p.tension.all()):
        yield from of_lever("joints", scene.joints)


def of_lever(table: str, joints: Joints) -> Iterator[str]:
    """Warn of contact points far from the edges of a face that may open under bending."""
    rule, count = joints.point_rule, joints.contact_points
    if (found := lever(rule, count)) < LEAST_LEVER:
        thicker = f"{1 / found:.3g} times the thickness" if found else "more than any thickness"
        yield (
            f"{table}.contact_points = {count} ({rule}): a face of rigid blocks that opens bears "
            f"at {found:.3g} of its half width, so that what stands by its edges needs {thicker}; "
            f"contact_points = 8 with point_rule = 'gauss' bears at {lever('gauss', 8):.3g}"
        )


RULES: tuple[Rule, ...] = (
    _of_poisson,
    _of_times,
    _of_wavelength,
    _of_step,
    _of_a_jump,
    _of_arrivals,
    _of_quiet_ends,
    _of_half_a_load,
    _of_receivers_at_joints,
    _of_contact_points,
)
