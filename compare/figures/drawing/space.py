"""The drawing of a rock mass in space, rendered by PyVista if installed."""

from importlib.util import find_spec
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_rgb

from jointwave.cases.geometry.blocks import Blocks
from jointwave.cases.geometry.cell_complex import OUTSIDE
from jointwave.cases.partition.scene import blocks_of_scene
from jointwave.cases.partition.shape import SIDES, shape_of
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.compare.figures.drawing.sketch import (
    INK,
    ROCKS,
    SETS,
    Sketch,
    lines,
    note,
    surroundings,
)
from jointwave.compare.figures.section import middle_of_openings

TURN, RISE = np.radians([28.0, 24.0])  # azimuth of the viewer from the front, and elevation
RIGHT = np.array([np.cos(TURN), np.sin(TURN), 0.0])
TOWARDS = np.array([np.sin(TURN), -np.cos(TURN), np.tan(RISE)]) * np.cos(RISE)  # the viewer
UP = np.cross(TOWARDS, RIGHT)
ONTO = np.stack([RIGHT, UP])  # coordinates in the drawing are ONTO @ x
LIGHT = np.array([0.25, -0.70, 0.67])  # direction to the light source
DARKEST = 0.6  # brightness of a face turned away from the light
EDGE, WIDTH = "#2b2820", 0.4  # edges of blocks, and their width (points)
WALLS = "#7d8794"  # faces of openings
MARGIN = 0.14  # beside the rock, over its size in the drawing
PIXELS = 1400  # width of an image


def sketch_of(scene: RockMass, explode: float = 0.0) -> Sketch:
    """Return the sketch of a scene in space, cut open through the middle of its openings.

    explode : how far blocks are moved apart, over their distance from the middle.
    """
    blocks, domain = blocks_of_scene(scene), shape_of(scene.domain)
    middle = middle_of_openings(scene)
    behind, has_openings = (-np.inf, False) if middle is None else (middle, True)
    shift = explode * (blocks.centroid - (domain.low + domain.high) / 2)
    faces, colours = _faces(scene, blocks, blocks.centroid[:, 1] > behind, shift)
    places = np.concatenate(faces) @ ONTO.T
    low, high = places.min(axis=0), places.max(axis=0)
    margin = MARGIN * float((high - low).max())
    low, high = low - margin, high + margin
    by_pyvista = find_spec("pyvista") is not None
    named = {one.name: SETS[k % len(SETS)] for k, one in enumerate(scene.joint_sets)}
    named = named if has_openings or explode else {}  # else no joint face is visible
    named |= {one.name: ROCKS[(k + 1) % len(ROCKS)] for k, one in enumerate(scene.regions)}
    named |= {"opening": WALLS} if has_openings else {}
    size = float((domain.high - domain.low).max())
    shapes = list[Artist]()
    if not by_pyvista:
        order = np.argsort([face.mean(axis=0) @ TOWARDS for face in faces])  # the farthest first
        look: dict[str, Any] = {"edgecolors": EDGE, "linewidths": WIDTH, "zorder": 1}
        look |= {"facecolors": colours[order], "label": "_blocks"}
        shapes.append(PolyCollection([faces[i] @ ONTO.T for i in order], **look))
    shapes += [
        *(PolyCollection([], facecolors=colour, label=name) for name, colour in named.items()),
        *surroundings(scene, domain, ONTO, size, 1 + explode),
    ]
    foot = low + 0.6 * margin
    for name, axis in zip("xyz", ONTO.T, strict=True):
        shapes += lines(f"_{name}", [[foot, foot + 0.5 * margin * axis]], INK, 1.0)
        shapes.append(note(foot + 0.75 * margin * axis, name, "center"))
    words = " × ".join(f"{x:g}" for x in domain.high - domain.low) + f" m, {blocks.count:,} blocks"
    words += f", moved apart by {explode:g} of their distance" if explode else ""
    words += "\ncut open through the middle of the openings" if has_openings else ""
    image = _rendered(faces, colours, low, high) if by_pyvista else None
    return Sketch(shapes, low, high, ("right", "up"), size=words, ticks="", image=image)


def _faces(
    scene: RockMass, blocks: Blocks, kept: np.ndarray, shift: np.ndarray
) -> tuple[list[np.ndarray], np.ndarray]:
    """Return visible faces [corners, 3], m, and their colours [n, 3] by joint set, opening or rock.

    kept : of each block [blocks]. shift : of the blocks [blocks, 3], m.
    """
    faces, colours = list[np.ndarray](), list[np.ndarray]()
    rocks = np.array([to_rgb(one) for one in ROCKS])[(blocks.body.region + 1) % len(ROCKS)]
    sets = np.array([to_rgb(SETS[k % len(SETS)]) for k in range(1 + len(scene.joint_sets))])
    for facets, k in ((blocks.contacts, 0), (blocks.contacts, 1), (blocks.boundary, 0)):
        own, other = facets.blocks[:, k], facets.blocks[:, 1 - k]
        normal, outer = (1 - 2 * k) * facets.normal, other == OUTSIDE
        seen = kept[own] & (normal @ TOWARDS > 0) & (outer | ~kept[other] | bool(shift.any()))
        of_joint = ~outer & (facets.joint_set >= 0)
        found = np.where(of_joint[:, None], sets[facets.joint_set], rocks[own])
        found[outer & (facets.side >= len(SIDES[3]))] = to_rgb(WALLS)
        lit = DARKEST + (1 - DARKEST) * np.clip(normal @ LIGHT, 0, 1)
        colours.append((found * lit[:, None])[seen])
        pieces = np.split(facets.outlines.corners, facets.outlines.first[1:-1])
        faces += [pieces[i] + shift[own[i]] for i in np.flatnonzero(seen)]
    return faces, np.concatenate(colours)


def _rendered(
    faces: list[np.ndarray], colours: np.ndarray, low: np.ndarray, high: np.ndarray
) -> np.ndarray:
    """Return an image [h, w, 4] of faces; low, high : its corners in the drawing [2], m."""
    import pyvista

    corners, last = np.concatenate(faces), np.cumsum([len(face) for face in faces])
    parts = np.split(np.arange(len(corners)), last[:-1])
    mesh = pyvista.PolyData.from_irregular_faces(corners, parts)
    (middle_x, middle_y), (width, height) = (low + high) / 2, high - low
    focus = middle_x * RIGHT + middle_y * UP
    with pyvista.vtk_verbosity("off"):  # no warnings about a missing display
        plotter = pyvista.Plotter(
            off_screen=True, window_size=[PIXELS, round(PIXELS * height / width)]
        )
        style = {"show_edges": True, "edge_color": EDGE, "lighting": False}
        plotter.add_mesh(mesh, scalars=(255 * colours).astype(np.uint8), rgb=True, **style)
        plotter.camera_position = [focus + 10 * mesh.length * TOWARDS, focus, UP]
        plotter.enable_parallel_projection()
        plotter.camera.parallel_scale = height / 2
        plotter.reset_camera_clipping_range()
        return plotter.screenshot(return_img=True, transparent_background=True)
