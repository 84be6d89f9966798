"""Actions on the two end faces: load, absorbing and fixed ends."""

from collections.abc import Iterator
from math import isfinite

import numpy as np
from scipy.sparse import csr_matrix, diags

from jointwave.cases.loads import base_steps, load_history, step_means
from jointwave.cases.material.calibrate import Properties
from jointwave.cases.material.jointed_rock import JointedRock
from jointwave.cases.sampling import Clock
from jointwave.cases.schema.scene import Scene
from jointwave.continuum.mesh.description import Side
from jointwave.continuum.model import Ends, Fixed, HalfJoints, Loaded, Quiet
from jointwave.continuum.space.body import Body, along
from jointwave.continuum.space.evaluation import Places, on_freedoms, places_in
from jointwave.continuum.space.interface import Facets, facet_points
from jointwave.continuum.space.kinematics import impedances
from jointwave.joints.ends import HalfSpring, half_spring


def build_ends(
    scene: Scene, p: Properties, body: Body, model: str, time: Clock, mass: np.ndarray
) -> Ends:
    """Return the loads and supports of a body's ends; mass : float array [freedoms], kg, total."""
    return Ends(
        loaded=load_on(scene, p, body, time),
        quiet=quiet_ends(scene, p, body, model, time.dt, mass),
        fixed=fixed_ends(scene, body, time),
    )


def load_on(scene: Scene, p: Properties, body: Body, time: Clock) -> Loaded | None:
    """Return the end stress as forces on the freedoms of the start, None where there is none."""
    if scene.shakes_base or not scene.load.amplitude:
        return None
    # A moment is traction linear across the face: Lobatto's two points of linear elements miss it.
    points, place = _face(body, body.mesh.start, body.order + 1)
    direction = load_shape(scene, p, body, points.x)
    weights = np.einsum("q,qk,qc->qkc", points.weight, place.basis, direction)
    (share,) = on_freedoms(body, place.cell, weights[None])
    freedom = np.flatnonzero(share)
    pressure = step_means(load_history(scene), time.dt, time.steps + 1)
    return Loaded(freedom, share[freedom], pressure)


def load_shape(scene: Scene, p: Properties, body: Body, x: np.ndarray) -> np.ndarray:
    """Return the traction [q, components] of a unit end stress at points x [q, dim] of the face.

    Force and moment are those that the load has; beside the uniform traction, moments are spread
    as in a long column: linear in x and z (Navier), and in torsion along circles about the axis.
    """
    components, load = body.section.components, scene.load
    if components == 1:
        return np.full((len(x), 1), load.direction[1])
    across = np.zeros((len(x), 2))
    if body.dim > 1:
        across[:, 0] = x[:, 0]
        across[:, 1] = x[:, 2] if body.dim == 3 else 0.0
    direction = np.array(load.direction, dtype=float)
    if load.arm is None:
        force, moment = direction, np.cross([load.at[0], 0.0, load.at[1]], direction)
    else:
        force, moment = np.zeros(3), load.arm * direction
    bent, twisted = 12 / p.side**2, 6 / p.side**2
    found = np.tile(force, (len(x), 1))
    found[:, 1] += bent * (moment[2] * across[:, 0] - moment[0] * across[:, 1])
    found[:, 0] += twisted * moment[1] * across[:, 1]
    found[:, 2] -= twisted * moment[1] * across[:, 0]
    return found[:, :components]


def quiet_ends(
    scene: Scene, p: Properties, body: Body, model: str, dt: float, mass: np.ndarray
) -> Quiet | None:
    """Return the absorbing ends, or None: dashpots rho c for P and S on the end faces.

    In jointed rock a matched end has half a joint in front of it, as the rock beyond would have.
    """
    parts: list[tuple[np.ndarray, ...]] = []
    for area, springs in absorbers(scene, p, body, model, dt):
        for share, whole, spring in zip(area, body.communicator.total(area), springs, strict=True):
            freedom = np.flatnonzero(whole)
            share, whole, alike = share[freedom], whole[freedom], np.ones(freedom.size)
            viscosity, stiffness = share * spring.viscosity, share * spring.stiffness
            rest = stiffness, spring.decay * alike, spring.gain * alike
            parts.append((freedom, viscosity, whole * spring.viscosity, *rest))
    if not parts:
        return None
    columns = [np.concatenate(column) for column in zip(*parts, strict=True)]
    freedom, viscosity, whole, stiffness, decay, gain = columns
    sprung = body.communicator.any(bool(stiffness.any()))
    half_joints = HalfJoints(stiffness, decay, gain) if sprung else None
    braked = 1 + (p.mass_damping or 0.0) * dt / 2  # as in the step over the mass
    beta = whole * dt / (2 * braked * mass[freedom])
    return Quiet(freedom, viscosity, beta, half_joints)


def absorbers(
    scene: Scene, p: Properties, body: Body, model: str, dt: float = 0.0
) -> Iterator[tuple[np.ndarray, list[HalfSpring]]]:
    """Yield for every absorbing end its area [components, freedoms] and what absorbs each component
    per unit area: half a joint before the rock beyond, or a dashpot alone."""
    components = body.section.components
    for place in ("start", "end"):
        kind = getattr(scene.ends, place)
        if kind not in ("quiet", "matched"):
            continue
        own = p.at_start if place == "start" else p.at_end
        sprung = kind == "matched" and model == "jointed" and isfinite(own.regular_own_stiffness)
        springs = [
            _half_joint(own, z, c == along(body.section), dt)
            if sprung
            else HalfSpring(0.0, z, 0.0, 0.0, 0.0)
            for c, z in enumerate(impedances(own, components))
        ]
        yield face_area(body, getattr(body.mesh, place)), springs


def _half_joint(p: JointedRock, z: float, is_normal: bool, dt: float) -> HalfSpring:
    k = p.regular_own_stiffness if is_normal else p.regular_own_shear_stiffness
    return half_spring(2 * k, p.time_constant or 0.0, z, dt)


def end_stiffness(scene: Scene, p: Properties, body: Body, model: str) -> np.ndarray:
    """Return the stiffness of matched ends at the critical step, N/m [freedoms]."""
    found = np.zeros(body.mass.size)
    for area, springs in absorbers(scene, p, body, model):
        for share, spring in zip(area, springs, strict=True):
            found += share * spring.critical_stiffness
    return found


def fixed_ends(scene: Scene, body: Body, time: Clock | None = None) -> Fixed | None:
    """Return the freedoms of fixed ends, those of a shaken base with its motion; None without."""
    freedoms, directions = [], []
    for place in ("start", "end"):
        if getattr(scene.ends, place) != "fixed":
            continue
        whole = body.communicator.total(face_area(body, getattr(body.mesh, place)))
        for c, area in enumerate(whole):
            freedoms.append(np.flatnonzero(area))
            component = 1 if body.section.components == 1 else c
            shaken = place == "start" and scene.shakes_base
            direction = scene.load.direction[component] if shaken else 0.0
            directions.append(np.full(freedoms[-1].size, direction))
    if not freedoms:
        return None
    step = None
    if scene.shakes_base and time is not None:
        step = base_steps(scene.load, time.dt, time.steps + 1)
    return Fixed(np.concatenate(freedoms), np.concatenate(directions).astype(float), step)


def borne_ends(scene: Scene, body: Body) -> csr_matrix | None:
    """Return the areas [freedoms, freedoms] (m2) of ends that bear the weight beside their
    dashpots; None without."""
    places = [place for place, bears in zip(("start", "end"), scene.bears, strict=True) if bears]
    if not places:
        return None
    areas = [face_area(body, getattr(body.mesh, place)).sum(axis=0) for place in places]
    return csr_matrix(diags(np.sum(areas, axis=0)))


def face_area(body: Body, side: Side) -> np.ndarray:
    """Return the area (m2) of a face that each freedom stands for [components, freedoms]."""
    points, place = _face(body, side)
    every = np.eye(body.section.components)
    weights = np.einsum("q,qk,dc->dqkc", points.weight, place.basis, every)
    return on_freedoms(body, place.cell, weights)


def _face(body: Body, side: Side, degree: int | None = None) -> tuple[Facets, Places]:
    """Return the quadrature points of an end face, and where they are in its cells."""
    points = facet_points(body, side.corners, degree)
    return points, places_in(body, side.cell[points.facet], points.x)
