"""Warnings about likely mistakes in a rock mass, one line each."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from jointwave.cases.checks.rock_mass import GRAZING
from jointwave.cases.errors import placed
from jointwave.cases.incident import across, plane_wave
from jointwave.cases.loads import LEAST_BLOCKS, highest_frequency
from jointwave.cases.material.closure import stresses
from jointwave.cases.material.quiet_sides import impedances
from jointwave.cases.material.rock import elastic_rock
from jointwave.cases.material.rock_mass import set_time_constants
from jointwave.cases.partition.joints import region_at, rocks_of
from jointwave.cases.partition.lattice import LAYER, thin_layers
from jointwave.cases.partition.scene import across_periodic, blocks_of_scene
from jointwave.cases.partition.shape import distance, loaded_lines, shape_of
from jointwave.cases.plausible import LENGTH, of_dip, of_value
from jointwave.cases.schema.pulse import PlaneLoad, Wave
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.cases.warnings.places import COINCIDENT, RULES_OF_PLACES
from jointwave.cases.warnings.sources import LEAST_DAMPING, of_dashpot, of_resolution, onset

NEAR_SIDE = 1e-6  # shift from a side into the rock, over the domain's size
EARLY = 1e-6  # rounding of a wave's onset, over the duration


def met(scene: RockMass) -> dict[str, Any]:
    """Return the arguments of `of_sources` for a rock mass."""
    keys, sets = ("friction_angle", "cohesion", "tensile_strength"), scene.entries("joint_sets")
    fails = any(one.tension is False or any(getattr(one, k) for k in keys) for _, one in sets)
    rock, acting = elastic_rock(scene.rock), [one for one in scene.pulses if one.amplitude]
    arrivals = (
        (f"{key}[{i}] = {placed(place)}", min(_arrival(scene, x, np.array(place)) for x in acting))
        for key in ("points", "joints")
        for i, place in enumerate(getattr(scene.record, key))
    )
    loads, opening = scene.entries("loads"), {} if scene.in_space else dict(sets)  # others in space
    return dict(
        crossings=fastest(scene) / float(scene.domain.extent.max()),
        block=(scene.numerics.dem.block or _block_size(scene)) if fails else None,
        speed=lambda one: float(rock.s_speed if one.kind == "S" else rock.p_speed),
        pressed={k: f"boundaries.{x.side}" for k, x in loads if x.kind == "pressure" and x.side},
        instead="one of the [[waves]] enters with its own amplitude",
        arrivals=arrivals if acting else (),
        opening={k: x for k, x in opening.items() if x.tension is False or x.tensile_strength},
        closing=_closing(scene),
        steepening=_steepening(scene),
    )


def _closing(scene: RockMass) -> Iterator[tuple[str, float, float, float]]:
    """Yield quiet sides, the stress added to the initial one, Pa, and the impedances of the rock
    there without and with it, Pa s/m, where these differ most."""
    if not any(one.maximum_closure for one in scene.joint_sets):
        return
    outline, added = shape_of(scene.domain), stresses(scene)[1]
    for side in scene.boundaries.sides("quiet"):
        for corners, n in outline.faces_of(side):
            places = (corners + corners.mean(axis=0)) / 2 - NEAR_SIDE * outline.size * n
            given = np.tile(n, (len(places), 1)), places, region_at(scene.regions, places)
            rest, closed = (n @ impedances(scene, *given, more=x) @ n for x in (0.0, added))
            k = int((closed / rest).argmax())
            yield f"boundaries.{side}", added, float(rest[k]), float(closed[k])


def _steepening(scene: RockMass) -> Iterator[tuple[str, float, float]]:
    """Yield plane waves and loads that close joints of sets without damping, their way, m, and the
    slowness that they lose at their peaks, s/m."""
    sets = [one for one in scene.joint_sets if one.maximum_closure and one.spacing]
    damped = scene.damping.rayleigh or all((x.damping_ratio or 0) >= LEAST_DAMPING for x in sets)
    corners, added = np.array(scene.domain.corners), stresses(scene)[1]
    places = np.array([corners.mean(axis=0), *scene.record.points])
    region = region_at(scene.regions, places)
    density = np.array([one.density for one in rocks_of(scene)])[region]
    for key, (n, motion) in ({} if damped else plane_waves(scene) or {}).items():
        if abs(n @ motion) > GRAZING:  # S waves hardly close joints
            given = np.tile(n, (len(places), 1)), places, region
            rest, closed = (n @ impedances(scene, *given, more=x) @ n for x in (0.0, added))
            way, lost = float(np.ptp(corners @ n)), float((density / rest - density / closed).max())
            yield from [(key, way, lost)] if lost > 0 else []


def fastest(scene: RockMass) -> float:
    """Return the largest P-wave speed in a rock mass, m/s."""
    return max(float(elastic_rock(one).p_speed) for one in rocks_of(scene))


def _of_directions(scene: RockMass) -> Iterator[str]:
    for key, one in scene.entries("regions"):
        yield from of_dip(f"{key}.dip", one.dip)
    for key in ("size", "outline"):
        for value in scene.domain.extent if getattr(scene.domain, key) else ():
            yield from of_value(f"domain.{key}", float(value), LENGTH)
    if scene.gravity is not None and scene.gravity.direction[-1] >= 0:
        way = "upwards" if scene.gravity.direction[-1] else "sideways"
        up = "z" if scene.in_space else "y"
        yield f"gravity.direction = {placed(scene.gravity.direction)} pulls {way}: {up} points up"


def _of_wavelength(scene: RockMass) -> Iterator[str]:
    """Warn of blocks or elements too large for the shortest wave: S, into which joints convert part
    of any wave, at the highest frequency."""
    frequency = highest_frequency(scene)
    if frequency is None:
        return
    wave = min(float(elastic_rock(one).s_speed) for one in rocks_of(scene)) / frequency
    where = f"per wavelength of S at {frequency:.4g} Hz, below which 95 % of the energy lies"
    size, given = scene.numerics.continuum.size, scene.numerics.dem.block
    block = given or _block_size(scene)
    if block is not None:
        file = scene.domain.blocks is not None
        key = "domain.blocks of" if file else "numerics.dem.block ="
        cut = "the largest of domain.blocks gives" if file else "the joint sets give"
        gives = f"numerics.dem.block = {given:g} m gives" if given else cut
        remedy = f": {key} {wave / LEAST_BLOCKS:.2g} m"
        yield from of_resolution(gives, wave / block, f"rigid blocks {where}", remedy)
    if size is not None:
        order = scene.numerics.continuum.order
        gives = f"numerics.continuum.size = {size:g} m, of order {order}, gives"
        yield from of_resolution(gives, order * wave / size, f"nodes {where}")


def _block_size(scene: RockMass) -> float | None:
    """Return the length of the largest block of a file, m, the root of its area or volume, or of
    the blocks of the joint sets: the spacings, and the domain's size along what none of them cuts
    unless all waves cross one set at right angles. None if no joints have a spacing: rigid blocks
    then need a given size."""
    sets = [one for one in scene.joint_sets if one.spacing]
    spacings = sorted(one.spacing for one in sets if one.spacing)
    if not sets:
        return None
    if scene.domain.blocks is not None:
        return float(blocks_of_scene(scene).volume.max() ** (1 / scene.domain.dimension))
    size, corners = float(scene.domain.extent.max()), np.array(scene.domain.corners)
    waves = plane_waves(scene)
    if len(scene.joint_sets) == 1 and waves is not None:
        along = scene.joint_sets[0].frame[1:]
        if all(np.abs(along @ direction).max() < GRAZING for direction, _ in waves.values()):
            # Under shear, blocks rotate that are as wide as the periodic domain.
            turned = any(np.abs(along @ motion).max() > GRAZING for _, motion in waves.values())
            wide = turned and bool(scene.boundaries.sides("periodic"))
            width = float(np.ptp(corners @ along.T, axis=0).max()) if wide else 0.0
            return min(max(spacings[0], width), size)
    _, cut, axes = np.linalg.svd(np.array([one.normal for one in sets]))
    rank = int((cut > GRAZING).sum())
    uncut = np.ptp(corners @ axes[rank:].T, axis=0).max(initial=0.0)
    return min(max(spacings[rank - 1], float(uncut)), size)


def plane_waves(scene: RockMass) -> dict[str, tuple[np.ndarray, np.ndarray]] | None:
    """Return the direction and the polarisation [d] of each plane wave by its table, including
    loads on a whole flat side; None if a load radiates waves in all directions."""
    found = {}
    for key, wave in scene.entries("waves"):
        n = np.array(wave.direction)
        found[key] = n, n if wave.kind == "P" else across(n, wave)
    normals = shape_of(scene.domain).normals()
    for key, load in scene.entries("loads"):
        inward = normals.get(load.side or "", np.zeros((0, 0)))
        if len(inward) != 1 or load.between is not None:
            return None
        n = inward[0]
        found[key] = n, n if load.direction is None else np.array(load.direction)
    return found


def _of_thin_layers(scene: RockMass) -> Iterator[str]:
    """Warn of layers whose rigid blocks are plates."""
    for name, thickness in thin_layers(scene):
        yield (
            f"region '{name}' is {thickness:.3g} m thick, less than {LAYER:g} of numerics.dem.block"
            f" = {scene.numerics.dem.block:g} m: it is not cut, and has no Poisson effect; stress "
            f"in it is off by up to 50 %, waves by up to 5 %: give {thickness / LAYER:.3g} m"
        )


def _of_rollers(scene: RockMass) -> Iterator[str]:
    """Warn of roller sides that hold back a wave travelling along them."""
    normals = shape_of(scene.domain).normals()
    for side in scene.boundaries.sides("roller"):
        for key, (direction, motion) in (plane_waves(scene) or {}).items():
            n = normals[side]
            if np.abs(n @ direction).max() < GRAZING < np.abs(n @ motion).max():
                yield (
                    f"boundaries.{side} = 'roller' holds the rock that {key} moves towards it, all "
                    "along its way: periodic sides move with the wave"
                )


def _of_halves(scene: RockMass) -> Iterator[str]:
    """Warn of rigid blocks that periodic sides cut in two; `dem.block` cuts rock anyway."""
    periodic = scene.boundaries.sides("periodic") and not scene.domain.mesh
    if not periodic or not scene.joint_sets or scene.numerics.dem.block:
        return
    for one in across_periodic(scene, blocks_of_scene(scene)):
        apart = one.contacts.blocks[:, 0] != one.contacts.blocks[:, 1]
        if many := np.count_nonzero(apart & ~one.contacts.of_joints(len(scene.joint_sets))):
            yield (
                f"boundaries.{one.sides[0]} = 'periodic' cuts {many} rigid blocks in two, whose "
                "halves move apart as the rock between their centres lets them: velocities were "
                "off by 2.5 % and a traction by 17 % where every second brick was cut, in twice "
                "the width by 0.6 and 1.2 %"
            )


def _of_parts(scene: RockMass) -> Iterator[str]:
    """Warn where a pressure acts on more than half of an opening, as if its points were swapped."""
    outline = shape_of(scene.domain)
    for i, load in enumerate(scene.loads):
        if load.between is not None and load.opening is not None:
            whole = np.diff(outline.edges(opening=load.opening), axis=1)[:, 0]
            of = float(np.hypot(*whole.T).sum())
            own = sum(float(np.hypot(*(b - a))) for a, b in loaded_lines(outline, load))
            if own > (0.5 + COINCIDENT) * of:
                yield (
                    f"loads[{i}].between is {own:.4g} m of the {of:.4g} m around opening "
                    f"{load.opening}, counter-clockwise from its first point to its second: in "
                    f"the other order it is the other {of - own:.4g} m"
                )


def _of_starts(scene: RockMass) -> Iterator[str]:
    """Warn of waves that are inside the domain at the start, when the rock is at rest."""
    corners = np.array(scene.domain.corners)
    for i, wave in enumerate(scene.waves):
        begun = -float(plane_wave(scene, wave).lateness(corners).min())
        early = begun > onset(wave) + EARLY * scene.time.duration
        if wave.amplitude and wave.through is not None and early:
            yield (
                f"waves[{i}].through = {placed(wave.through)}: the wave enters the domain "
                f"{begun:.3g} s before t = 0, when the rock is at rest: move it back"
            )


def _of_dashpots(scene: RockMass) -> Iterator[str]:
    """Warn of single joints, whose dashpots depend on the size of the domain."""
    for i, one in enumerate(scene.joint_sets):
        if one.damping_ratio and one.spacing is None:
            etas = set_time_constants(scene)
            assert etas is not None
            length = "half of the domain's extent across it"
            yield of_dashpot(f"joint_sets[{i}]", one.damping_ratio, length, etas[i])


def _of_seeds(scene: RockMass) -> Iterator[str]:
    """Warn of joint sets with one seed."""
    first: dict[int, int] = {}
    for i, one in enumerate(scene.joint_sets):
        if one.seed is not None and (k := first.setdefault(one.seed, i)) != i:
            yield (
                f"joint_sets[{i}].seed = {one.seed} is that of joint_sets[{k}]: their spacings "
                "scatter alike"
            )


def _arrival(scene: RockMass, pulse: Wave | PlaneLoad, place: np.ndarray) -> float:
    """Return the time when a wave or load first reaches a place in intact rock, s."""
    if isinstance(pulse, Wave):
        return onset(pulse) + float(plane_wave(scene, pulse).lateness(place[None])[0])
    if pulse.at is None:
        away = distance(place, shape_of(scene.domain).faces_of(pulse.side, pulse.opening))
    else:
        away = float(np.linalg.norm(place - pulse.at))
    return onset(pulse) + away / fastest(scene)


RULES = (
    *RULES_OF_PLACES,
    _of_directions,
    _of_wavelength,
    _of_thin_layers,
    _of_rollers,
    _of_halves,
    _of_parts,
    _of_starts,
    _of_dashpots,
    _of_seeds,
)
