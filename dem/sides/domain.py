"""Dashpots, loads and incident waves on the sides of a rock mass."""

from dataclasses import replace
from math import inf

import numpy as np
from scipy.sparse import csr_array

from jointwave.cases import incident
from jointwave.cases.geometry.blocks import Blocks
from jointwave.cases.geometry.measure import Outlines, along_and_across
from jointwave.cases.histories import LoadHistory, Step
from jointwave.cases.loads import step_means, velocity_of
from jointwave.cases.material.quiet_sides import base_traction, borne, impedances
from jointwave.cases.material.rock import wave_moduli
from jointwave.cases.material.rock_mass import refuse_beyond_strength
from jointwave.cases.partition.joints import rocks_of
from jointwave.cases.partition.shape import covered
from jointwave.cases.sampling import Clock
from jointwave.cases.schema.pulse import PlaneLoad, shortest_period
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.dem.readings.receivers import stencils_at
from jointwave.dem.sides.boundaries import (
    BoundaryPoints,
    facets_on,
    points_on,
    resultants,
    summed,
)
from jointwave.dem.sides.loads import Pattern, Source, reactions
from jointwave.dem.sides.shaking import Base
from jointwave.dem.sides.surroundings import Surroundings

#: Samples per period of a pulse, of a field that is not evaluated at every step.
IN_A_PERIOD = 200


def surroundings_of(scene: RockMass, cut: Blocks, sides: tuple[str, ...]) -> Surroundings:
    """Return the surroundings of a rock mass; sides : names of the boundary's sides, in order.

    Raises SceneError for a prestress beyond the strength of joints that must hold.
    """
    refuse_beyond_strength(scene)
    quiet = points_on(cut, facets_on(cut, sides, scene.boundaries.sides("quiet")))
    impedance = impedances(scene, quiet.normal, quiet.place, cut.body.region[quiet.block])
    reach = (quiet.arm * quiet.normal).sum(axis=1)
    springs = half_blocks(scene, cut.body.region[quiet.block], reach)
    patterns = [load_pattern(scene, cut, sides, one) for one in scene.pushes]
    opened = None
    if scene.prestress is not None:
        # Openings have been excavated: nothing holds their walls.
        stress, openings = scene.prestress.tensor, [s for s in sides if s.startswith("opening")]
        bear = facets_on(cut, sides, scene.boundaries.sides("free", "quiet"))
        slide = facets_on(cut, sides, scene.boundaries.sides("roller"))
        patterns.append(reactions(cut, bear, stress))
        patterns.append(reactions(cut, slide, stress, along=True))
        if scene.excavated:
            opened = reactions(cut, facets_on(cut, sides, openings), stress)

    def waves(field: incident.IncidentField | None, rows: np.ndarray, time: Clock) -> list[Source]:
        field = incident.free_field(scene) if field is None else field
        return incoming(field, shortest_period(scene.waves), quiet, impedance, rows, time)

    return Surroundings(
        points=quiet,
        impedance=impedance,
        borne=borne(scene, quiet.normal) @ along_and_across(quiet.normal, springs),
        patterns=patterns,
        bases=[Base(one.side or "", one, np.array(one.direction)) for one in scene.bases],
        opened=opened,
        waves=waves if scene.waves and len(quiet.block) else None,
    )


def half_blocks(scene: RockMass, region: np.ndarray, reach: np.ndarray) -> np.ndarray:
    """Return normal and shear stiffness [n, 2], Pa/m, of the rock of regions [n] between blocks'
    centroids and sides at distances `reach` [n], m."""
    moduli = np.array([wave_moduli(one) for one in rocks_of(scene)])
    return moduli[region] / reach[:, None]


def load_pattern(
    scene: RockMass, blocks: Blocks, sides: tuple[str, ...], load: PlaneLoad
) -> Pattern:
    """Return the forces of a pressure, a point force or a compliant base."""
    history = velocity_of(load, load.amplitude)
    if load.kind == "force":
        return _force(scene, blocks, load, history)
    facets, parts = facets_on(blocks, sides, [load.side or f"opening {load.opening}"]), None
    if load.between is not None:
        facets, parts = _covered(scene, blocks, load, facets)
    points = points_on(blocks, facets, parts)
    if load.kind == "base":
        assert load.direction is not None
        regions = blocks.body.region[points.block]
        impedance = impedances(scene, points.normal, points.place, regions)
        traction = base_traction(impedance, load.direction)
    else:
        traction = -points.normal
    return Pattern(points.block, points.arm, points.area[:, None] * traction, history)


def _force(scene: RockMass, blocks: Blocks, load: PlaneLoad, history: LoadHistory) -> Pattern:
    """Return a point force on the blocks of a receiver at the point, with the receiver's weights:
    so two such forces satisfy reciprocity."""
    direction, rows = np.array(load.direction), list[tuple[int, np.ndarray, float]]()
    for one in stencils_at(scene, blocks, np.array([load.at])):
        rows += [(k, 0 * one.arm, weight) for k, weight in zip(one.at, one.weight, strict=True)]
        rows += [(one.at[0], one.arm, 1.0), (one.at[0], 0 * one.arm, -1.0)]  # its moment
    block, arm, share = map(np.array, zip(*sorted(rows, key=lambda row: row[0]), strict=True))
    return Pattern(block, arm, share[:, None] * direction, history)


def _covered(
    scene: RockMass, blocks: Blocks, load: PlaneLoad, facets: np.ndarray
) -> tuple[np.ndarray, Outlines]:
    """Return the edges under a load that acts between two places, and their loaded parts."""
    edges = blocks.boundary.ends[facets]
    part = covered(scene.domain, load, edges)
    acts = part[:, 1] > part[:, 0]
    start, end = edges[acts, :1], edges[acts, 1:]
    place = part[acts, :, None]
    ends = start * (1 - place) + end * place
    return facets[acts], Outlines(ends.reshape(-1, 2), 2 * np.arange(acts.sum() + 1))


def delayed(row: np.ndarray, unit: np.ndarray, history: LoadHistory, late: np.ndarray) -> Source:
    """Return forces at points with a common history, each with its own delay.

    row : of each point [m]. unit : resultants for a history of 1 [m, d + d^2]. late : delays [m],
    s. Forces are means over a step.
    """

    def acting(steps: np.ndarray, dt: float, rows: np.ndarray, onto: np.ndarray) -> np.ndarray:
        own, size = np.flatnonzero(np.isin(row, rows)), len(onto)
        mean = step_means(history, dt, steps, late[own, None])
        place = size * np.searchsorted(rows, row[own])[:, None] + np.arange(size)
        entries = (
            (unit[own] @ onto.T).ravel(),
            (place.ravel(), np.repeat(np.arange(len(own)), size)),
        )
        matrix = csr_array(entries, shape=(size * len(rows), len(own)))
        return np.ascontiguousarray((matrix @ mean).T).reshape(-1, len(rows), size)

    return acting


def incoming(
    field: incident.IncidentField,
    period: float | None,
    points: BoundaryPoints,
    impedance: np.ndarray,
    rows: np.ndarray,
    time: Clock,
) -> list[Source]:
    """Return the forces of an incident field at the points of quiet sides.

    period : shortest period of its waves, s, or None. impedance : of the dashpots [m, d, d],
    Pa s/m. rows : held blocks [h]. Plane waves are evaluated at every step; another field once, at
    the sampling interval or more finely.
    """
    row = np.searchsorted(rows, points.block)

    def found(field: incident.IncidentField, times: np.ndarray) -> np.ndarray:
        pulled = incident.tractions(field, points.place, points.normal, impedance, times).values
        return resultants(points.arm, pulled * points.area[:, None])

    if isinstance(field, incident.FreeField):
        unit = [incident.FreeField((replace(one, pulse=Step(1.0)),)) for one in field.waves]
        return [
            delayed(row, found(still, np.array([inf]))[0], one.pulse, one.lateness(points.place))
            for still, one in zip(unit, field.waves, strict=True)
        ]
    interval = min(time.dt * time.stride, (period or inf) / IN_A_PERIOD)
    times = interval * np.arange(int(np.ceil(time.dt * time.steps / interval)) + 4)
    samples = incident.FaceTractions(times, summed(found(field, times), row, len(rows)))
    return [
        lambda steps, dt, some, onto: samples.at(dt * steps, lambda all_: all_[:, some] @ onto.T)
    ]
