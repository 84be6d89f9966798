"""The drawing of a rock mass: joints, boundaries, waves and loads, receivers."""

from typing import Any

import numpy as np

from jointwave.cases.partition.blocks import Partition
from jointwave.cases.partition.outline import outline_of
from jointwave.cases.partition.regions import rocks_of
from jointwave.cases.partition.scene import partition_of
from jointwave.cases.schema.plane import IntactRock
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.cases.schema.sources import PlaneLoad, Wave
from jointwave.compare.figures.drawing.pulses import law_words
from jointwave.compare.figures.drawing.sketch import (
    EDGE,
    REGIONS,
    ROCK,
    SOFT,
    Arrow,
    Lines,
    Sketch,
    gravity_words,
    pushing,
    shaking,
    side_style,
)

#: Colours of joint sets, in order; safe for all kinds of colour blindness (Tol 2021, bright).
SETS = ("#4477aa", "#ee6677", "#228833", "#aa3377", "#ccbb44", "#66ccee")
OVER = 0.16  # margin for arrows, of the domain's size
LENGTH, SHORT = 0.12, 0.05  # of the domain's size: arrows of waves, and other arrows
MOST = 12  # arrows of a pressure on one edge
DENSE = 3000  # contacts above which their lines are thin
#: What a drawing shows.
SEEN = (
    *("domain", "regions", "joint_sets", "waves", "loads", "boundaries", "gravity", "prestress"),
    "record",
)


def appearance(scene: RockMass) -> str:
    """Return everything that determines the drawing of a rock mass."""
    return str([getattr(scene, key) for key in SEEN])


def sketch_of(scene: RockMass) -> Sketch:
    """Return the sketch of a rock mass, cut into blocks."""
    partition = partition_of(scene)
    low, high = partition.corners.min(axis=0), partition.corners.max(axis=0)
    margin, rocks = OVER * (high - low), (ROCK, *REGIONS)
    width = 0.4 if len(partition.contacts) > DENSE else 0.9
    lines = {}
    for k, name in [*enumerate(partition.joint_sets), (-1, "no joint")]:
        dashes = "-" if k >= 0 else (0, (1.0, 2.0))
        colour = SETS[k % len(SETS)] if k >= 0 else EDGE
        segments = _joint_lines(partition, k)
        if len(segments):
            lines[name] = Lines(
                segments, {"color": colour, "linewidth": width, "linestyle": dashes}
            )
    sides: dict[str, list[np.ndarray]] = {}
    for side, segments in _sides(partition).items():
        sides.setdefault(_held(scene, side), []).append(segments)
    lines |= {
        f"{held} side": Lines(np.concatenate(found), side_style(held))
        for held, found in sides.items()
    }
    record = scene.record
    marks = {"point": ("o", record.points), "point of a joint": ("^", record.joints)}
    off = 0.015 * (high - low)
    arrows, notes = _actions(scene, low, high)
    notes += [
        (np.add(at, off), f"[{at[0]:g}, {at[1]:g}]", "left")
        for at in (*record.points, *record.joints)
    ]
    return Sketch(
        low - margin,
        high + margin,
        1.0,
        ("x", "y"),
        "",
        np.split(partition.corners, partition.first[1:-1]),
        [rocks[(k + 1) % len(rocks)] for k in partition.region],
        {one.name: REGIONS[k % len(REGIONS)] for k, one in enumerate(scene.regions)},
        lines,
        {name: (mark, np.array(places)) for name, (mark, places) in marks.items() if places},
        arrows,
        notes,
    )


def _joint_lines(partition: Partition, index: int) -> np.ndarray:
    """Return the contacts of a set [n, 2, 2], m; -1: cuts through intact rock."""
    of = partition.contacts
    own = of.joint_set == index
    return np.stack([of.start[own], of.end[own]], axis=1)


def _sides(partition: Partition) -> dict[str, np.ndarray]:
    """Return the edges of each side [n, 2, 2], m."""
    edges = partition.boundary
    lines = np.stack([edges.start, edges.end], axis=1)
    found = {name: lines[edges.side == k] for k, name in enumerate(partition.sides)}
    return {name: own for name, own in found.items() if len(own)}


def _held(scene: RockMass, side: str) -> str:
    """Return the boundary condition of a side; openings are free."""
    return getattr(scene.boundaries, side, "free")


def _actions(scene: RockMass, low: np.ndarray, high: np.ndarray) -> tuple[list[Arrow], list]:
    """Return the arrows and notes of all actions on a rock mass from `low` to `high`, m."""
    size, arrows, notes = float((high - low).min()), list[Arrow](), list[tuple[Any, str, str]]()
    for wave in scene.waves:
        arrows += _of_wave(wave, low, high, size)
        left = np.array([-wave.direction[1], wave.direction[0]])
        middle = (arrows[-1].tail + arrows[-1].tip) / 2
        notes.append((middle + 0.045 * size * left, wave.kind, "center"))
    for load in scene.loads:
        arrows += _of_load(scene, load, size)
    above = high[1] + 0.4 * LENGTH * size
    if scene.gravity is not None and scene.gravity.acceleration:
        direction, at = np.array(scene.gravity.direction), np.array([low[0], above])
        arrows.append(pushing(at + SHORT * size * direction, direction, SHORT * size, SOFT))
        notes.append((at + 0.02 * size * np.array([1, 0]), gravity_words(scene.gravity), "left"))
    if scene.prestress is not None:
        stress = scene.prestress
        words = f"prestress {stress.xx / 1e6:g}, {stress.yy / 1e6:g}, {stress.xy / 1e6:g} MPa"
        notes.append((np.array([high[0], above]), words, "right"))
    return arrows, notes


def _of_wave(wave: Wave, low: np.ndarray, high: np.ndarray, size: float) -> list[Arrow]:
    """Return an arrow to the entry point of a line through the middle along the direction of
    travel; before it, of an S wave, the particle motion."""
    middle, n = (low + high) / 2, np.array(wave.direction)
    with np.errstate(divide="ignore"):
        reach = float(np.min((high - low) / 2 / np.abs(n)))
    travel = pushing(middle - (reach + 0.01 * size) * n, n, LENGTH * size)
    left = np.array([-n[1], n[0]])
    beside = (travel.tail + travel.tip) / 2 - 0.06 * size * left
    motion = [shaking(beside, left, 0.1 * size)] if wave.kind == "S" else []
    return [*motion, travel]


def _of_load(scene: RockMass, load: PlaneLoad, size: float) -> list[Arrow]:
    """Return the arrow of a force or a shaken side, or those of a pressure, onto the rock."""
    if load.kind == "force":
        assert load.at is not None
        return [pushing(np.array(load.at), np.array(load.direction), 1.5 * SHORT * size)]
    edges = outline_of(scene.domain).edges(load.side, load.opening)
    start, end = edges[:, 0], edges[:, 1]
    if load.kind == "base":
        return [shaking((start[0] + end[-1]) / 2, np.array(load.direction), 2 * SHORT * size)]
    along = end - start
    length = np.hypot(*along.T)
    inwards = np.stack([-along[:, 1], along[:, 0]], axis=1) / length[:, None]
    if load.opening is not None:
        inwards = -inwards  # its edges go around the opening, with the rock outside
    counts = np.clip(np.round(length / (SHORT * size)), 1, MOST).astype(int)
    return [
        pushing(a + (k + 0.5) / count * step, normal, 0.7 * SHORT * size)
        for a, step, normal, count in zip(start, along, inwards, counts, strict=True)
        for k in range(count)
    ]


def caption(scene: RockMass) -> str:
    """Return the description of the drawing."""
    sets = "; ".join(_set_words(one) for one in scene.joint_sets)
    named = zip(scene.regions, rocks_of(scene), strict=False)  # the last is [rock]
    regions = "; ".join(f"{one.name}: {_rock_words(own)}" for one, own in named)
    parts = [
        f"From the scene file: rock of {_rock_words(scene.rock)}, in plane strain.",
        f"Regions: {regions}." if regions else "",
        f"Joints: {sets}." if sets else "No joints.",
        "Circles: points whose motion is recorded; triangles: points of joints.",
    ]
    return " ".join(part for part in parts if part)


def _rock_words(rock: IntactRock) -> str:
    return (
        f"{rock.density:g} kg/m³ with a modulus of {rock.intact_modulus / 1e9:.3g} GPa and a "
        f"Poisson's ratio of {rock.intact_poisson:g}"
    )


def _set_words(one: Any) -> str:
    parts = [
        f"dip {one.dip:g}°",
        f"spacing {one.spacing:g} m" if one.spacing else "one joint",
        f"{one.normal_stiffness / 1e9:.3g} and {one.shear_stiffness / 1e9:.3g} GPa/m",
        law_words(one),
    ]
    return f"{one.name}: {', '.join(part for part in parts if part)}"
