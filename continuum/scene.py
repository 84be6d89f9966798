"""The body of a scene: a rock mass in the plane or in space, or a pillar."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from jointwave.cases.errors import SceneError
from jointwave.cases.geometry.blocks import Blocks
from jointwave.cases.geometry.cell_complex import Complex, GeometryError
from jointwave.cases.geometry.measure import Outlines
from jointwave.cases.geometry.periodic import Across, of_all
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.material.effective_medium import tensor
from jointwave.cases.partition.pillar import SIDES, blocks_of_pillar
from jointwave.cases.partition.scene import across_periodic, blocks_of_scene
from jointwave.cases.partition.shape import shape_of
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.cases.schema.scene import Scene
from jointwave.continuum.joints import layers_of, resolved_joints
from jointwave.continuum.mesh.boxes import along_edges, box_mesh, boxes_of, extents
from jointwave.continuum.mesh.conforming import Conforming, marks_of
from jointwave.continuum.mesh.given import mesh_of_file
from jointwave.continuum.mesh.periodic import facing, fitted, matching_facets, matching_vertices
from jointwave.continuum.mesh.simplices import are_simplices, own_cells, simplex_mesh
from jointwave.continuum.mesh.size import element_size, elements_along, refuse_large_mesh
from jointwave.continuum.space import rock as materials
from jointwave.continuum.space.build import Elements
from jointwave.continuum.space.model import Body
from jointwave.continuum.space.own_rock import materials_of
from jointwave.continuum.space.rock import Material, Rock
from jointwave.continuum.validity import dimension_of

KEPT = 8  # bodies


class SceneBody(NamedTuple):
    """A scene as a body.

    scene : with its resolved joint sets only. across : contacts across periodic sides. of_cell :
    index of each cell's material [cells]. scripted : whether a script gave the rock. model : of the
    joints, "jointed" or "equivalent".
    """

    scene: AnyScene
    blocks: Blocks
    across: list[Across]
    materials: list[Material]
    of_cell: np.ndarray
    scripted: bool
    body: Body
    model: str = "jointed"

    def of_cells(self, name: str) -> np.ndarray:
        """Return a property of the material of each cell [cells, ...]."""
        return np.array([getattr(one, name) for one in self.materials])[self.of_cell]

    def moduli(self, pairs: Iterable[tuple[int, int]]) -> np.ndarray:
        """Return the stress components i, j per displacement gradient in each material
        [materials, n, components, d], Pa; in one dimension the axial stress only."""
        stiffness = np.array([one.stiffness for one in self.materials])
        if self.body.x.shape[1] > 1:
            full = np.array([tensor(one) for one in stiffness])
            return np.stack([full[:, i, j] for i, j in pairs], axis=1)
        along = self.body.components // 2
        moduli = np.zeros((len(stiffness), 1, stiffness.shape[1], 1))
        moduli[:, 0, along, 0] = stiffness[:, along, along]
        return moduli


#: Resolved scene, blocks, contacts across periodic sides, arguments of `Elements`, and materials.
Meshed = tuple[AnyScene, Blocks, list[Across], tuple[Any, ...], list[Material]]


def body_of(
    scene: AnyScene, model: str = "jointed", rock: Rock | None = None, dim: int | None = None
) -> SceneBody:
    """Return the body of a scene; model, rock and dim as in `continuum.run.simulate`.

    Raises SceneError if the scene cannot be cut or meshed.
    """
    try:
        if scene.is_column:
            meshed = _pillar(scene, model, dimension_of(scene, dim))
        else:
            meshed = _rock_mass(scene, model)
        resolved, blocks, across, given, own = meshed
        if rock is None:
            body, of_cell = _build.get()(given, own, blocks.body.region)
        else:
            elements = Elements(*given)
            forms = rock(scene, elements.space)
            own, of_cell = materials_of(scene, elements.space, forms, own)
            body = elements.body(forms)
    except ImportError as error:
        key, cell = "numerics.continuum.cell", scene.numerics.continuum.cell
        raise SceneError(scene.where, key, cell, str(error)) from None
    return SceneBody(resolved, blocks, across, own, of_cell, rock is not None, body, model)


def _built(
    given: tuple[Any, ...], own: list[Material], region: np.ndarray
) -> tuple[Body, np.ndarray]:
    """Return a body, and the index of the material of each cell; region : index of each block."""
    elements = Elements(*given)
    of_cell = region[elements.block]
    return elements.body(materials.rock_of_cells(elements.space, own, of_cell)), of_cell


_build = ContextVar[Callable[..., tuple[Body, np.ndarray]]]("_build", default=_built)


@contextmanager
def bodies_kept() -> Iterator[None]:
    """Let runs of equal rock and elements share a body, which is built, and warned of, once."""
    import joblib

    kept = dict[str, tuple[Body, np.ndarray]]()

    def build(*parts: Any) -> tuple[Body, np.ndarray]:
        if (key := joblib.hash(parts)) not in kept:
            if len(kept) == KEPT:
                kept.pop(next(iter(kept)))
            kept[key] = _built(*parts)
        return kept[key]

    before = _build.set(build)
    try:
        yield
    finally:
        _build.reset(before)


def _rock_mass(scene: RockMass, model: str) -> Meshed:
    smeared = [one for one in scene.joint_sets if model == "equivalent" and one.spacing is not None]
    kept = [one for one in scene.joint_sets if one not in smeared]
    resolved, shape = scene.model_copy(update={"joint_sets": kept}), shape_of(scene.domain)
    blocks = blocks_of_scene(resolved)
    across = across_periodic(scene, blocks)
    blocks = replace(blocks, body=fitted(blocks.body, across))
    joint, body = of_all(blocks, across, "joint_set") >= 0, blocks.body
    corners = body.corners_of_facets()
    first = np.searchsorted(corners[:, 0], np.arange(len(body.sides) + 1))
    side = shape.sides_of(Outlines(body.vertices[corners[:, 1]], first), body.side)
    marks = marks_of(blocks, np.where(joint, np.arange(len(joint)), -1), side, shape.sides)
    try:
        mesh = _mesh_of_rock_mass(scene, blocks, across)
        first = np.cumsum([len(blocks.contacts), *(len(one.contacts) for one in across)])
        faces = [facing(mesh, body, *one) for one in zip(across, first[:-1], strict=True)]
    except GeometryError as error:
        raise SceneError(scene.where, error.key, None, str(error)) from None
    given = mesh, marks, scene.numerics.continuum.order, body.dim, faces
    return resolved, blocks, across, given, materials.rock_mass(scene, smeared, model)


def _mesh_of_rock_mass(scene: RockMass, blocks: Blocks, across: list[Across]) -> Conforming:
    body, numerics = blocks.body, scene.numerics.continuum
    boxes = None if numerics.cell == "triangle" else boxes_of(body)
    if numerics.cell == "quadrilateral" and boxes is None:
        allowed = "not every block has four edges with one neighbour each"
        raise SceneError(scene.where, "numerics.continuum.cell", numerics.cell, allowed)
    size = element_size(scene, boxes is None, float(np.ptp(body.vertices, axis=0).min()))
    if np.isfinite(size):
        refuse_large_mesh(scene, blocks, size, body.dim)
    if boxes is None:
        return _simplices(scene, body, size, across)
    wanted = np.ceil(extents(body, boxes.corners) / size * (1 - 1e-9))
    like = matching_vertices(body, across)
    counts = along_edges(boxes.corners, np.maximum(1, wanted).astype(int), like)
    return box_mesh(body, boxes, counts)


def _simplices(
    scene: AnyScene, body: Complex, size: float, across: Sequence[Across] = ()
) -> Conforming:
    """Return a mesh of simplices; raises SceneError for orders without a diagonal mass."""
    if (order := scene.numerics.continuum.order) > 2:
        allowed = "must be at most 2 for triangles and tetrahedra"
        raise SceneError(scene.where, "numerics.continuum.order", order, allowed)
    if not np.isfinite(size) and are_simplices(body):
        return own_cells(body)
    return simplex_mesh(body, size, [(matching_facets(body, one), one.shift) for one in across])


def _pillar(scene: Scene, model: str, dim: int) -> Meshed:
    """Return the elements of a pillar in `dim` dimensions; a joint's column is its number."""
    p, numerics = calibrate(scene), scene.numerics.continuum
    size = 3 if dim == 1 and scene.is_spatial else dim
    layers = layers_of(scene) if numerics.mesh is None else {}
    joints = resolved_joints(scene, model, size > 1, numerics.mesh is None)
    halves = np.append(joints.share, 0.0) + np.append(0.0, joints.share)
    less = {int(k): float(halves[k]) for k in np.flatnonzero(halves)}
    if numerics.mesh is None:
        blocks = blocks_of_pillar(scene, dim, layers)
        region, each = blocks.body.region.copy(), elements_along(scene, model)
        own = np.flatnonzero(region < len(each))  # not of layers
        region[own[list(less)]] = len(each) + len(layers) + np.arange(len(less))
        blocks = replace(blocks, body=replace(blocks.body, region=region))
        joint = np.arange(p.block_count - 1)
        joint = np.repeat(joint, 1 + np.isin(joint, [*layers]))  # a layer has two contacts
        marked = np.where(np.isin(joint, joints.number), joint, -1)
        marks = marks_of(blocks, marked, blocks.body.side, SIDES)
        each = np.concatenate([each, np.ones(len(layers), int), each[p.segment[list(less)]]])
        mesh = _mesh_of_pillar(scene, blocks, each, size)
    else:
        blocks, mesh, marks = mesh_of_file(scene, joints.number, dim)
    flat = scene.motion.rotation == "none" and dim > 1
    given = mesh, marks, numerics.order, size, (), flat
    return scene, blocks, [], given, materials.pillar(scene, model, size, dim, less)


def _mesh_of_pillar(scene: Scene, blocks: Blocks, each: np.ndarray, components: int) -> Conforming:
    """Return the mesh of a pillar; each : elements along a block of each region."""
    body, numerics, many = blocks.body, scene.numerics.continuum, each[blocks.body.region]
    across, faces = numerics.elements_across, body.dim - 1
    cells = float(many.sum()) * across**faces
    counts = {"elements_per_block": float(many.mean()), "elements_across": float(across**faces)}
    most = max(counts, key=lambda name: counts[name])
    key = f"numerics.continuum.{most}" if counts[most] > 1 else "pillar.block"
    size = (blocks.volume.sum() / cells) ** (1 / body.dim)
    refuse_large_mesh(scene, blocks, size, components, key)
    if numerics.cell == "simplex" and faces:
        longest = blocks.volume / scene.pillar.side**faces / many
        return _simplices(scene, body, min(scene.pillar.side / across, longest.min()))
    boxes = boxes_of(body)
    assert boxes is not None
    ends = body.vertices[boxes.corners[:, np.append(0, 1 << np.arange(body.dim))]]
    lengthwise = np.abs(ends[:, 1:] - ends[:, :1]).argmax(axis=2) == body.dim // 2
    return box_mesh(body, boxes, np.where(lengthwise, many[:, None], across))
