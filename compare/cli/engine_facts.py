"""Properties of each engine's model of a scene: speeds of waves, levers of contact points."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import isfinite, sqrt
from typing import TYPE_CHECKING, Any

import numpy as np

from cases.effects import bends
from cases.kinds import AnyScene
from cases.material.calibrate import Properties, calibrate
from cases.material.contact_points import lever
from cases.material.elastic import shear_modulus
from cases.schema.joint import Joints
from cases.schema.scene import Scene
from cases.schema.segment import alone, regions
from compare.engines import ENGINES
from compare.solvers.record import Rock

if TYPE_CHECKING:
    from cases.schema.rock_mass import RockMass

RIGID = 1e3  #: times the speed of intact rock: no strain at all
AXES = {"x": [1.0, 0.0], "y": [0.0, 1.0]}

#: Speeds along the pillar, or of P waves, and across it, or of S waves, m/s, by what has them.
Speeds = dict[str, tuple[float, float]]


def speeds_of(scene: AnyScene, engines: list[str]) -> dict[str, Speeds]:
    """Return the speeds of the waves in a scene by engine; of rock masses in the rock of no region.

    Long waves are those of wavelengths that are large against the blocks and a pillar's side.
    """
    speeds: Any = _of_pillar if isinstance(scene, Scene) else _of_rock_mass
    return {name: speeds(scene, ENGINES[name].rock) for name in engines}


def speed_words(scene: AnyScene, found: dict[str, Speeds]) -> list[str]:
    """Return a line for each engine."""
    fast, where = "bar", ""
    if not isinstance(scene, Scene):
        fast, where = "P", " in the rock of no region" if scene.regions else ""
    return [
        f"waves in {name}{where}, m/s: "
        + "; ".join(f"{what}: {fast} {_number(p)}, S {_number(s)}" for what, (p, s) in own.items())
        for name, own in found.items()
    ]


def speed_facts(found: dict[str, Speeds]) -> dict[str, Any]:
    """Return the same as JSON takes it; None where nothing gives way."""
    return {
        name: {what: [v if np.isfinite(v) else None for v in pair] for what, pair in own.items()}
        for name, own in found.items()
    }


def levers_of(scene: AnyScene, engines: list[str]) -> dict[str, float]:
    """Return by engine how far the outermost points of joints are from the centre of a face, over
    its half width; of rock masses of the joint set that has the least. Empty where nothing bends.
    """
    if isinstance(scene, Scene) and not bends(scene):
        return {}
    rules: Sequence[Joints] = [scene.joints] if isinstance(scene, Scene) else scene.joint_sets
    found = {}
    for name in engines:
        rock = ENGINES[name].rock
        if rock is Rock.RIGID_BLOCKS and rules:
            found[name] = min(lever(one.point_rule, one.contact_points) for one in rules)
        elif rock is Rock.JOINTED and (of_elements := _of_elements(scene)) is not None:
            found[name] = of_elements
    return found


def _of_elements(scene: AnyScene) -> float | None:
    """Return that of the joints between elements; None of a pillar's mesh that a file gives."""
    from continuum.mesh.cells import KINDS
    from continuum.space import interface
    from continuum.space.kinematics import kinematics

    if not isinstance(scene, Scene):
        return interface.lever("triangle", scene.numerics.continuum.order)
    numerics = scene.numerics.continuum
    if numerics.mesh is not None:
        return None
    kind = KINDS[kinematics(scene).dim, numerics.cell]
    return interface.lever(kind, numerics.order, numerics.elements_across)


def lever_words(found: dict[str, float]) -> str:
    """Return a line of them."""
    each = ", ".join(f"{name} {value:.3g}" for name, value in found.items())
    return f"a joint's face that opens bears at this part of its half width: {each}"


def _number(speed: float) -> str:
    return f"{speed:.4g}" if np.isfinite(speed) else "none (rigid)"


def _of_pillar(scene: Scene, rock: Rock) -> Speeds:
    """Return the speeds of each segment, and those between joints that stand apart from rock."""
    p, found = calibrate(scene), {}
    ends = p.contact_y[np.cumsum([0, *(one.block_count for one in p.each)])].tolist()
    for one, region, (start, stop) in zip(p.each, regions(scene), pairwise(ends), strict=True):
        where = f"{start:g} to {stop:g} m, " if len(p.each) > 1 else ""
        found[f"{where}long waves"] = one.bar_speed, one.shear_speed
        if rock is Rock.JOINTED and isfinite(one.regular_own_stiffness):
            found[f"{where}between joints"] = _intact(one, alone(scene, region))
    return found


def _intact(p: Properties, scene: Scene) -> tuple[float, float]:
    modulus, poisson = p.intact_modulus, scene.rock.intact_poisson
    assert modulus is not None
    return sqrt(modulus / p.density), sqrt(shear_modulus(modulus, poisson) / p.density)


def _of_rock_mass(scene: RockMass, resolved: Rock) -> Speeds:
    from cases.material.effective_medium import compliant, stiffness
    from cases.material.rigid_blocks import long_wave_stiffness
    from cases.material.rock import elastic_rock
    from cases.partition.lattice import further_sets
    from cases.partition.regions import within

    if resolved is Rock.RIGID_BLOCKS:
        return _along_axes(long_wave_stiffness(scene, further_sets(scene)), scene)
    rock = elastic_rock(scene.rock)
    sets = compliant(within(scene, scene.joint_sets)[-1].joint_sets)
    found = _along_axes(stiffness(rock, sets), scene) if sets else {}
    if resolved is Rock.JOINTED or not sets:
        found["intact rock"] = float(rock.p_speed), float(rock.s_speed)
    return found


def _along_axes(medium: np.ndarray, scene: RockMass) -> Speeds:
    """Return the speeds of a medium's long waves along x and y."""
    from cases.material.effective_medium import speeds
    from cases.material.rock import elastic_rock

    found, shapes = speeds(medium, scene.rock.density, np.array(list(AXES.values())))
    found[found > RIGID * float(elastic_rock(scene.rock).p_speed)] = np.inf
    pairs = {}
    for name, direction, squares, shape in zip(AXES, AXES.values(), found, shapes, strict=True):
        p = int(np.abs(np.array(direction) @ shape).argmax())
        pairs[f"long waves along {name}"] = float(squares[p]), float(squares[1 - p])
    return pairs
