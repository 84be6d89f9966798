"""The body of a scene: a rock mass in the plane or in space, or a pillar."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from jointwave.cases.effects import is_spatial
from jointwave.cases.errors import SceneError
from jointwave.cases.geometry.blocks import Blocks
from jointwave.cases.geometry.cell_complex import Complex, GeometryError
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.partition.periodic import Across, across_periodic, of_all
from jointwave.cases.partition.pillar import blocks_of_pillar
from jointwave.cases.partition.scene import blocks_of_scene
from jointwave.cases.partition.shape import shape_of
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.cases.schema.scene import Scene
from jointwave.continuum.joints import resolved_joints
from jointwave.continuum.mesh.boxes import along_edges, box_corners, box_mesh, extents
from jointwave.continuum.mesh.conforming import Conforming
from jointwave.continuum.mesh.domain import marks_of
from jointwave.continuum.mesh.given import ENDS, mesh_of_file
from jointwave.continuum.mesh.periodic import facing, fitted, matching_facets, matching_vertices
from jointwave.continuum.mesh.simplices import are_simplices, own_cells, simplex_mesh
from jointwave.continuum.mesh.size import element_size, elements_along, refuse_large_mesh
from jointwave.continuum.space import rock as materials
from jointwave.continuum.space.build import SIMPLEX, build_body
from jointwave.continuum.space.model import Body
from jointwave.continuum.space.own_rock import ChosenRock
from jointwave.continuum.space.rock import Material, Rock
from jointwave.continuum.validity import dimension_of


class SceneBody(NamedTuple):
    """A scene as a body: its resolved joint sets, blocks, contacts across periodic sides, its
    materials, which of them each cell has, int array [cells], whether a script gave its rock, its
    body, and the model of its joints."""

    scene: AnyScene
    blocks: Blocks
    across: list[Across]
    materials: list[Material]
    of_cell: np.ndarray
    scripted: bool
    body: Body
    model: str = "jointed"


def body_of(
    scene: AnyScene,
    model: str = "jointed",
    rock: Rock | None = None,
    implicit: bool = False,
    dim: int | None = None,
) -> SceneBody:
    """Return the body of a scene; model : "jointed", or "equivalent" where sets of joints that have
    a spacing, and a pillar's, are an effective medium.

    rock : of the scene, of a function of its own. implicit : whether steps need no diagonal mass.
    dim : of a pillar's mesh, in place of the scene's.

    Raises SceneError where the scene cannot be cut or meshed as it asks for.
    """
    try:
        if scene.is_column:
            return _pillar(scene, model, rock, implicit, dimension_of(scene, dim))
        return _rock_mass(scene, model, rock, implicit)
    except ImportError as error:
        key = "numerics.continuum.cell"
        raise SceneError(scene.where, key, scene.numerics.continuum.cell, str(error)) from None


def _rock_mass(scene: RockMass, model: str, rock: Rock | None, implicit: bool) -> SceneBody:
    smeared = [one for one in scene.joint_sets if model == "equivalent" and one.spacing is not None]
    kept = [one for one in scene.joint_sets if one not in smeared]
    resolved = scene.model_copy(update={"joint_sets": kept})
    blocks, numerics = blocks_of_scene(resolved), scene.numerics.continuum
    across, dim = across_periodic(scene, blocks), blocks.body.dim
    blocks = replace(blocks, body=fitted(blocks.body, across))
    joint = of_all(blocks, across, "joint_set") >= 0
    marks = marks_of(blocks, joint, shape_of(scene.domain).sides)
    try:
        mesh = _mesh_of_rock_mass(scene, blocks, across)
        first = np.cumsum([len(blocks.contacts), *(len(one.contacts) for one in across)])
        faces = [facing(mesh, blocks.body, *one) for one in zip(across, first[:-1], strict=True)]
    except GeometryError as error:
        raise SceneError(scene.where, error.key, None, str(error)) from None
    own = materials.rock_mass(scene, smeared, model)
    chosen = ChosenRock(scene, rock, own, blocks.body.region)
    whole = implicit and numerics.order == 2 and mesh.kind in SIMPLEX
    body = build_body(mesh, marks, numerics.order, chosen, dim, whole, faces)
    return SceneBody(resolved, blocks, across, *chosen.found, body, model)


def _mesh_of_rock_mass(scene: RockMass, blocks: Blocks, across: list[Across]) -> Conforming:
    body, numerics = blocks.body, scene.numerics.continuum
    corners = None if numerics.cell == "triangle" else box_corners(body)
    if numerics.cell == "quadrilateral" and corners is None:
        allowed = "not every block has four edges with one neighbour each"
        raise SceneError(scene.where, "numerics.continuum.cell", numerics.cell, allowed)
    size = element_size(scene, corners is None)
    if np.isfinite(size):
        refuse_large_mesh(scene, blocks, size, body.dim)
    if corners is not None:
        wanted = np.maximum(1, np.ceil(extents(body, corners) / size * (1 - 1e-9))).astype(int)
        like = matching_vertices(body, across)
        return box_mesh(body, corners, along_edges(corners, wanted, like))
    _refuse_order(scene)
    if not np.isfinite(size) and are_simplices(body):
        return own_cells(body)
    alike = [(matching_facets(body, one), one.shift) for one in across]
    return simplex_mesh(body, size, alike)


def _pillar(scene: Scene, model: str, rock: Rock | None, implicit: bool, dim: int) -> SceneBody:
    """Return the body of a pillar in so many dimensions."""
    if scene.numerics.continuum.mesh is not None:
        return _pillar_of_file(scene, model, rock, implicit, dim)
    components = 3 if dim == 1 and is_spatial(scene) else dim
    p, numerics, layers = calibrate(scene), scene.numerics.continuum, materials.layers_of(scene)
    blocks, along = blocks_of_pillar(scene, dim, layers), dim // 2
    normal = blocks.boundary.normal[:, along]
    end = np.select([normal < -0.5, normal > 0.5], [0, 1], 2)
    blocks = replace(blocks, boundary=replace(blocks.boundary, side=end))
    ones = np.ones(len(layers), int)
    number = np.arange(p.block_count - 1)  # the joint of each contact, of a layer's two the same
    number = np.repeat(number, 1 + np.isin(number, [*layers]))
    joint = np.isin(number, resolved_joints(p, model, components > 1, tuple(layers)).number)
    mesh = _mesh_of_pillar(scene, blocks, np.append(elements_along(scene, model), ones), components)
    own = materials.pillar(scene, model, components, dim)
    chosen = ChosenRock(scene, rock, own, blocks.body.region)
    marks, consistent = marks_of(blocks, joint, ENDS), numerics.mass == "consistent" and implicit
    flat = scene.motion.rotation == "none" and dim > 1
    body = build_body(mesh, marks, numerics.order, chosen, components, consistent, flat=flat)
    if body.joints is not None:
        body = body._replace(joints=body.joints._replace(column=number[body.joints.column]))
    return SceneBody(scene, blocks, [], *chosen.found, body, model)


def _pillar_of_file(
    scene: Scene, model: str, rock: Rock | None, implicit: bool, dim: int
) -> SceneBody:
    """Return the body of a pillar on a mesh of the user's, which is one block with joints in it."""
    resolved, numerics = resolved_joints(calibrate(scene), model, True), scene.numerics.continuum
    blocks, mesh, marks = mesh_of_file(scene, resolved.number, dim)
    consistent = numerics.mass == "consistent" and implicit
    own = materials.pillar(scene, model, dim, dim)
    chosen = ChosenRock(scene, rock, own, blocks.body.region)
    flat = scene.motion.rotation == "none"
    body = build_body(mesh, marks, numerics.order, chosen, dim, consistent, flat=flat)
    return SceneBody(scene, blocks, [], *chosen.found, body, model)


def _mesh_of_pillar(scene: Scene, blocks: Blocks, each: np.ndarray, components: int) -> Conforming:
    """Return the mesh of the blocks of a pillar; each : elements along those of each region."""
    body, numerics, many = blocks.body, scene.numerics.continuum, each[blocks.body.region]
    across, faces = numerics.elements_across, body.dim - 1
    cells = float(many.sum()) * across**faces
    counts = {"elements_per_block": float(many.mean()), "elements_across": float(across**faces)}
    most = max(counts, key=lambda name: counts[name])
    key = f"numerics.continuum.{most}" if counts[most] > 1 else "pillar.block"
    size = (blocks.volume.sum() / cells) ** (1 / body.dim)
    refuse_large_mesh(scene, blocks, size, components, key)
    if numerics.cell == "simplex" and faces:
        _refuse_order(scene)
        longest = blocks.volume / scene.pillar.side**faces / many
        return simplex_mesh(body, min(scene.pillar.side / across, longest.min()))
    corners = box_corners(body)
    assert corners is not None
    return box_mesh(body, corners, _along(body, corners, many, across))


def _refuse_order(scene: AnyScene) -> None:
    """Raise SceneError where simplices have no diagonal mass."""
    if (order := scene.numerics.continuum.order) > 2:
        allowed = "must be at most 2 for triangles and tetrahedra"
        raise SceneError(scene.where, "numerics.continuum.order", order, allowed)


def _along(body: Complex, corners: np.ndarray, many: np.ndarray, across: int) -> np.ndarray:
    """Return the numbers of cells along the axes of the blocks of a pillar, int array [n, d]."""
    arms = body.vertices[corners[:, 1 << np.arange(body.dim)]] - body.vertices[corners[:, :1]]
    lengthwise = np.abs(arms).argmax(axis=2) == body.dim // 2
    return np.where(lengthwise, many[:, None], across)
