"""Warnings about likely mistakes in a pillar, one line each."""

from collections.abc import Iterator
from math import pi
from typing import Any

import numpy as np

from jointwave.cases.loads import LEAST_BLOCKS, shortest_wave
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.material.closure import stresses
from jointwave.cases.partition.pillar import welds
from jointwave.cases.schema.scene import Scene
from jointwave.cases.schema.tables import Rock
from jointwave.cases.warnings.sources import LEAST_DAMPING, of_dashpot, of_resolution, onset

POISSON = Rock.model_fields["intact_poisson"].default
MOST_REFLECTED = 0.01  # reflection by a quiet end on a rigid block at the highest frequency
MOST_AT_ENDS = 0.05  # difference of that wave between an end block's face and its middle
ON_JOINT = 1e-9  # rounding of a receiver's place, over the pillar's length and over a block


def met(scene: Scene) -> dict[str, Any]:
    """Return the arguments of `of_sources` for a pillar."""
    load, p = scene.load, calibrate(scene)
    # Bending runs ahead of shear, up to the speed of the bar (Timoshenko 1921).
    shear_alone = load.is_across and not load.direction[1] and scene.motion.rotation == "none"
    twist = load.arm is not None and not load.is_across
    speed = p.shear_speed if shear_alone or twist else p.at_rest.bar_speed
    begin, fails = onset(load), bool(p.given) or not p.tension.all()
    arrivals = (
        (f"{key} = {y:g} m", begin + (y / speed if p.is_uniform else p.travel_time(y)))
        for key in ("stress", "velocity")
        for y in getattr(scene.record, key)
    )
    breaks = any(one.tensile_strength is not None for one in (scene.joints, *scene.layers))
    bends = scene.is_spatial and scene.rotation != "none" and not (twist and scene.gravity is None)
    opens = bends and (breaks or not p.tension.all())
    ends, added = zip(scene.ends, (p.at_start, p.at_end), strict=True), stresses(scene)[1]
    return dict(
        crossings=p.bar_speed / scene.pillar.length,
        block=scene.pillar.block if fails else None,
        speed=lambda _: p.shear_speed if load.is_across else p.bar_speed,
        pressed={"load": "ends.start"} if load.quantity == "stress" else {},
        instead="load.quantity = 'incident-stress' is the stress that enters",
        arrivals=arrivals if load.amplitude else (),
        opening={"joints": scene.joints} if opens else {},
        steepening=_steepening(scene, added),
        closing=(
            (f"ends.{end}", most, rock.at_rest.impedance, rock.under(most).impedance)
            for (end, kind), rock in ends
            for most in [rock.prestress + added]
            if kind in ("quiet", "matched") and scene.source is None
        ),
    )


def _steepening(scene: Scene, added: float) -> Iterator[tuple[str, float, float]]:
    """Yield the load if it closes joints without damping, its way, m, and the slowness that it
    loses at its peak, s/m."""
    rock = calibrate(scene).at_start
    rest, under = rock.at_rest, rock.under(rock.prestress + added)
    ratio = (rock.time_constant or 0.0) * rest.bar_speed / (2 * rock.spacing)
    lost = 1 / rest.bar_speed - 1 / under.bar_speed
    if scene.load.direction[1] and ratio < LEAST_DAMPING and lost > 0:
        yield "load", min(scene.pillar.length, scene.time.duration * under.bar_speed), lost


def _of_poisson(scene: Scene) -> Iterator[str]:
    rock, p = scene.rock, calibrate(scene)
    if rock.p_speed and p.poisson < 0:
        yield (
            f"rock.p_speed = {rock.p_speed:g} below sqrt(2) rock.s_speed = {rock.s_speed:g} m/s "
            f"gives a negative Poisson's ratio, {p.poisson:.3g}"
        )
    given = rock.equivalent_modulus or rock.p_speed
    if given and rock.intact_modulus is None and rock.intact_poisson != POISSON:
        poisson = rock.intact_poisson
        yield f"rock.intact_poisson = {poisson:g} is not used: it needs rock.intact_modulus"


def _of_wavelength(scene: Scene) -> Iterator[str]:
    wave, p = shortest_wave(scene, calibrate(scene)), calibrate(scene)
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
        yield from of_resolution(f"{block} gives", wave.blocks, f"blocks per wavelength {where}")
    if (count := scene.numerics.continuum.elements_per_block) is not None:
        order = scene.numerics.continuum.order
        gives = f"numerics.continuum.elements_per_block = {count}, of order {order}, gives"
        nodes = order * count * wave.blocks
        yield from of_resolution(gives, nodes, f"nodes per wavelength {where}")


def _of_quiet_ends(scene: Scene) -> Iterator[str]:
    """Warn of the reflection by a dashpot on a whole block, except in scenes with a source."""
    wave = shortest_wave(scene, calibrate(scene))
    if wave is None or scene.source is not None or wave.reflection <= MOST_REFLECTED:
        return
    for key in ("start", "end"):
        if getattr(scene.ends, key) == "quiet":
            yield (
                f"ends.{key} = 'quiet' reflects {wave.reflection:.2g} of the wave at "
                f"{wave.frequency:.4g} Hz from rigid blocks; 'matched' {wave.reflection**2:.1g}"
            )


def _of_dashpots(scene: Scene) -> Iterator[str]:
    """Warn of soft layers in intact rock whose dashpots depend on the blocks it is cut into."""
    p, welded = calibrate(scene), welds(scene)
    for k, (joint, layer) in enumerate(zip(p.soft, scene.layers, strict=True)):
        if layer.damping_ratio and welded[joint] and p.own_time_constant is not None:
            length = f"{np.diff(p.contact_y)[joint]:.3g} m of intact rock"
            eta = p.own_time_constant[joint]
            yield of_dashpot(f"soft_layers[{k}]", layer.damping_ratio, length, eta)


def _of_receivers_at_joints(scene: Scene) -> Iterator[str]:
    """Warn of velocity receivers at soft layers, across which velocities jump."""
    for y in scene.record.velocity:
        for layer in scene.soft_layers:
            where, away = f"record.velocity = {y:g} m", abs(y - layer.y)
            if away <= ON_JOINT * scene.pillar.length:
                yield f"{where} lies on a soft layer: it is the mean of both sides"
            elif away < (0.5 - ON_JOINT) * calibrate(scene).spacing:
                yield (
                    f"{where} lies within half a block of the soft layer at {layer.y:g} m: rigid "
                    "blocks interpolate across it, between their centres"
                )


def _of_receivers_at_ends(scene: Scene) -> Iterator[str]:
    """Warn of velocity receivers near ends that deform under waves, unlike rigid blocks."""
    wave, p, load = shortest_wave(scene, calibrate(scene)), calibrate(scene), scene.load
    sheared, walls = load.is_across or load.arm is not None, (0.0, scene.pillar.length)
    for (end, kind), wall, centre, rock in zip(
        scene.ends, walls, p.centre_y[[0, -1]], (p.at_start, p.at_end), strict=True
    ):
        if wave is None or kind == "fixed" or (kind, end) == ("free", "end"):
            continue
        half = rock.wall_shear_stiffness if sheared else rock.wall_stiffness
        impedance = rock.shear_impedance if sheared else rock.impedance
        off = 2 * pi * wave.frequency * impedance / half
        for y in scene.record.velocity if off > MOST_AT_ENDS else ():
            if abs(y - wall) < (1 - ON_JOINT) * abs(centre - wall):
                yield (
                    f"record.velocity = {y:g} m lies in the last half block before the {end}: "
                    f"rigid blocks move there as in their middle, at {centre:.4g} m, "
                    f"{off:.2g} off at {wave.frequency:.4g} Hz"
                )


RULES = (
    _of_poisson,
    _of_wavelength,
    _of_quiet_ends,
    _of_dashpots,
    _of_receivers_at_joints,
    _of_receivers_at_ends,
)
