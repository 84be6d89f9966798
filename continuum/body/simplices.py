"""Blocks of any shape in triangles or tetrahedra, by gmsh: its points, lines, surfaces and volumes
are the vertices, edges, faces and cells of the complex, so that neighbours fit each other."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from jointwave.cases.geometry.cell_complex import Complex
from jointwave.continuum.body.conforming import SIMPLICES, Conforming, on_facets
from jointwave.continuum.mesh.session import gmsh_session

LINE, TRIANGLE, TETRAHEDRON = 1, 2, 4  # gmsh's types of elements


def simplex_mesh(
    body: Complex, size: float, alike: Sequence[tuple[np.ndarray, np.ndarray]] = ()
) -> Conforming:
    """Return the mesh of a complex in the plane or in space, of simplices of about this size, m.

    alike : pairs of facets that are divided alike, int array [n, 2], the first of them moved by a
    shift [d], m, from the second.

    Raises ImportError, with the way to install it, where gmsh is not there.
    """
    with gmsh_session() as gmsh:
        for name in ("Geometry.AutoCoherence", "Mesh.MeshSizeExtendFromBoundary"):
            gmsh.option.setNumber(name, 0)
        gmsh.option.setNumber("Mesh.MeshSizeMax", size)
        _draw(gmsh.model.geo, body, size)
        gmsh.model.geo.synchronize()
        for pairs, shift in alike:
            move = np.eye(4)
            move[: body.dim, 3] = shift
            for far, near in (pairs + 1).tolist():
                gmsh.model.mesh.setPeriodic(body.dim - 1, [far], [near], move.ravel().tolist())
        gmsh.model.mesh.generate(body.dim)
        return _read(gmsh.model.mesh, body)


def own_cells(body: Complex) -> Conforming:
    """Return the mesh of a complex whose cells are simplices, as they are."""
    half, dim = body.halves(), body.dim
    cells = body.corners(half)[:, 1].reshape(-1, dim + 1)
    number = np.arange(len(body.sides))
    vertices = body.corners_of_facets()[:, 1].reshape(-1, dim)
    on = on_facets(SIMPLICES[dim], cells, vertices, number, len(body.vertices))
    return _oriented(Conforming(SIMPLICES[dim], body.vertices, cells, np.arange(body.count), on))


def are_simplices(body: Complex) -> bool:
    """Return whether all cells of a complex are triangles or tetrahedra."""
    half = body.halves()
    facets, corners = (
        np.bincount(cell, minlength=body.count) for cell in (half.cell, body.corners(half)[:, 0])
    )
    return bool((facets == body.dim + 1).all() and (corners == body.dim + 1).all())


def _oriented(mesh: Conforming) -> Conforming:
    """Return a mesh of simplices whose cells have positive volumes."""
    arms = mesh.x[mesh.cells[:, 1:]] - mesh.x[mesh.cells[:, :1]]
    turned = np.linalg.det(arms) < 0
    cells, on = mesh.cells.copy(), mesh.on.copy()
    for array in (cells, on):  # facet k is the one without corner k
        array[turned, -2:] = array[turned, -2:][:, ::-1]
    return mesh._replace(cells=cells, on=on)


def _draw(geo: Any, body: Complex, size: float) -> None:
    """Add the complex to gmsh; tags are numbers in the complex, from 1 on."""
    x = np.zeros((len(body.vertices), 3))
    x[:, : body.dim] = body.vertices
    ends = body.bounds[0][:, 1].reshape(-1, 2)
    for tag, place in enumerate(x.tolist(), 1):
        geo.addPoint(*place, tag=tag)
    length = np.linalg.norm(x[ends[:, 0]] - x[ends[:, 1]], axis=1)
    counts = np.maximum(1, np.ceil(length / size * (1 - 1e-9))).astype(int)
    for tag, (pair, count) in enumerate(zip((ends + 1).tolist(), counts.tolist(), strict=True), 1):
        geo.addLine(*pair, tag=tag)
        geo.mesh.setTransfiniteCurve(tag, count + 1)
    half = body.halves()
    order = np.argsort(half.cell, kind="stable")
    cells = np.stack([half.cell, half.facet], axis=1)[order]
    for tag, lines in _listed(body.bounds[1] if body.dim == 3 else cells):
        geo.addPlaneSurface([_loop(geo, ends, lines)], tag=tag)
    if body.dim == 3:
        for tag, surfaces in _listed(cells):
            geo.addVolume([geo.addSurfaceLoop(surfaces)], tag=tag)


def _listed(pairs: np.ndarray) -> list[tuple[int, list[int]]]:
    """Return the tags of what things are bounded by; pairs : int array [m, 2], in order."""
    owner, first = np.unique(pairs[:, 0], return_index=True)
    each = np.split(pairs[:, 1] + 1, first[1:])
    return [(int(k) + 1, one.tolist()) for k, one in zip(owner, each, strict=True)]


def _loop(geo: Any, ends: np.ndarray, lines: list[int]) -> int:
    """Add a closed loop of lines, given in any order, and return its tag."""
    left = {tag: ends[tag - 1].tolist() for tag in lines[1:]}
    loop, (_, at) = [lines[0]], ends[lines[0] - 1].tolist()
    while left:
        tag = next(k for k, pair in left.items() if at in pair)
        a, b = left.pop(tag)
        loop.append(tag if a == at else -tag)
        at = b if a == at else a
    return int(geo.addCurveLoop(loop))


def _read(mesh: Any, body: Complex) -> Conforming:
    """Return gmsh's mesh of a complex."""
    dim = body.dim
    tags, places, _ = mesh.getNodes()
    number = np.zeros(int(np.max(tags)) + 1, np.int64)
    number[np.asarray(tags, np.int64)] = np.arange(len(tags))
    x = np.asarray(places).reshape(-1, 3)[:, :dim]
    kinds = {1: LINE, 2: TRIANGLE, 3: TETRAHEDRON}
    cells, block = _elements(mesh, kinds[dim], dim, body.count)
    vertices, facet = _elements(mesh, kinds[dim - 1], dim - 1, len(body.sides))
    used, cells = np.unique(number[cells], return_inverse=True)
    cells = cells.reshape(-1, dim + 1)
    at = np.zeros(len(x), np.int64)
    at[used] = np.arange(len(used))
    kind = SIMPLICES[dim]
    on = on_facets(kind, cells, at[number[vertices]], facet, len(used))
    return _oriented(Conforming(kind, x[used], cells, block, on))


def _elements(mesh: Any, kind: int, dim: int, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return elements in entities of a dimension, tags of nodes [n, dim + 1], and the numbers of
    their entities [n]."""
    found = [mesh.getElementsByType(kind, tag)[1] for tag in range(1, count + 1)]
    number = np.repeat(np.arange(count), [len(one) // (dim + 1) for one in found])
    return np.concatenate(found).astype(np.int64).reshape(-1, dim + 1), number
