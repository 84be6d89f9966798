"""Meshes of triangles or tetrahedra for blocks of any shape, by gmsh.

In the plane equal blocks are meshed once, and the mesh is shifted to each of them. Neighbours
conform since the division of an edge depends on its length only. In space vertices, edges, faces
and cells of the complex become gmsh's points, lines, surfaces and volumes.
"""

from collections import defaultdict
from collections.abc import Sequence
from typing import Any

import numpy as np

from jointwave.cases.geometry.cell_complex import Complex, GeometryError
from jointwave.cases.geometry.relations import composed, distinct, merged
from jointwave.continuum.mesh.conforming import SIMPLICES, Conforming, on_facets
from jointwave.continuum.mesh.session import gmsh_session

ALIKE = 1e-8  # difference, over the size of the body, between equal blocks
LINE, TRIANGLE, TETRAHEDRON = 1, 2, 4  # gmsh's types of elements
KINDS = {1: LINE, 2: TRIANGLE, 3: TETRAHEDRON}


#: Equal blocks [n], their first vertices [n], and their facets [n, k] in a common order.
Alike = tuple[np.ndarray, ...]


def simplex_mesh(
    body: Complex, size: float, alike: Sequence[tuple[np.ndarray, np.ndarray]] = ()
) -> Conforming:
    """Return the mesh of a complex in the plane or in space, of simplices of about this size, m.

    alike : pairs of faces in space with equal meshes [n, 2], and shifts [3], m, from the second.

    Raises ImportError, with installation instructions, without gmsh, and GeometryError where edges
    are too short to be told apart.
    """
    tolerance = ALIKE * float(np.ptp(body.vertices, axis=0).max())
    groups = _equal_blocks(body, tolerance)
    with gmsh_session() as gmsh:
        for name in ("Geometry.AutoCoherence", "Mesh.MeshSizeExtendFromBoundary"):
            gmsh.option.setNumber(name, 0)
        gmsh.option.setNumber("Mesh.MeshSizeMax", size)
        drawing = _Drawing(gmsh.model, body, size, tolerance)
        tags = [drawing.block(facets[0].tolist()) for *_, facets in groups]
        gmsh.model.geo.synchronize()
        for pairs, shift in alike if body.dim == 3 else ():
            drawing.repeat(pairs, shift)
        gmsh.model.mesh.generate(body.dim)
        found = [_read(gmsh.model.mesh, body.dim, *one) for one in tags]
    return _placed(body, groups, found, tolerance)


def _equal_blocks(body: Complex, tolerance: float) -> list[Alike]:
    """Return groups of blocks that are equal up to a shift; in space each block alone."""
    half, x = body.halves(), body.vertices
    groups: dict[Any, list] = defaultdict(list)
    facets_of = distinct(np.stack([half.cell, half.facet], axis=1))
    middles = body.means(body.corners_of_facets(), len(body.sides))
    each = [np.split(of[:, 1], np.searchsorted(of[:, 0], np.arange(1, body.count)))
            for of in (facets_of, body.corners(half))]  # fmt: skip
    for cell, (facets, vertices) in enumerate(zip(*each, strict=True)):
        steps = np.rint((x[vertices] - x[vertices].min(axis=0)) / tolerance).astype(np.int64)
        first = vertices[np.lexsort(steps.T)[0]]  # the same one in equal shapes
        key, order = [], np.zeros(0)
        for places in (x[vertices], middles[facets]):
            steps = np.rint((places - x[first]) / tolerance).astype(np.int64)
            order = np.lexsort(steps.T)
            key.append(steps[order].tobytes())
        groups[tuple(key) if body.dim == 2 else cell].append((cell, first, facets[order]))
    return [tuple(map(np.array, zip(*one, strict=True))) for one in groups.values()]


class _Drawing:
    """A complex in gmsh: tags of its points, lines and surfaces drawn so far, by number; in the
    plane those of the last block only."""

    def __init__(self, model: Any, body: Complex, size: float, tolerance: float) -> None:
        self.model, self.body, self.size, self.tolerance = model, body, size, tolerance
        self.ends = body.bounds[0][:, 1].reshape(-1, 2)
        self.points: dict[int, int] = {}
        self.lines: dict[int, int] = {}
        self.surfaces: dict[int, int] = {}

    def block(self, facets: list[int]) -> tuple[int, list[int]]:
        """Draw a block with these facets; return its tag and the tags of the facets."""
        geo = self.model.geo
        if self.body.dim == 2:
            self.points, self.lines = {}, {}
            return geo.addPlaneSurface([self._loop(facets)]), [self.lines[k] for k in facets]
        for facet in facets:
            if facet not in self.surfaces:
                edges = composed(np.array([[0, facet]]), self.body.bounds[1])[0][:, 1]
                self.surfaces[facet] = geo.addPlaneSurface([self._loop(edges.tolist())])
        tags = [self.surfaces[facet] for facet in facets]
        return geo.addVolume([geo.addSurfaceLoop(tags)]), tags

    def _line(self, edge: int) -> int:
        """Draw an edge, with divisions by its length; return its tag."""
        geo, x, ends = self.model.geo, self.body.vertices, self.ends[edge].tolist()
        if edge not in self.lines:
            for vertex in ends:
                if vertex not in self.points:
                    self.points[vertex] = geo.addPoint(*[*x[vertex].tolist(), 0.0][:3])
            self.lines[edge] = geo.addLine(*(self.points[vertex] for vertex in ends))
            # Less than the tolerance of equal edges, so that these have equal divisions.
            length = np.linalg.norm(x[ends[1]] - x[ends[0]]) - 4 * self.tolerance
            count = max(1, int(np.ceil(length / self.size)))
            geo.mesh.setTransfiniteCurve(self.lines[edge], count + 1)
        return self.lines[edge]

    def _loop(self, edges: list[int]) -> int:
        """Draw the closed loop of edges, given in any order; return its tag."""
        left = {edge: self.ends[edge].tolist() for edge in edges[1:]}
        loop, (_, at) = [self._line(edges[0])], self.ends[edges[0]].tolist()
        while left:
            edge = next(k for k, pair in left.items() if at in pair)
            a, b = left.pop(edge)
            loop.append(self._line(edge) * (1 if a == at else -1))
            at = b if a == at else a
        return int(self.model.geo.addCurveLoop(loop))

    def repeat(self, pairs: np.ndarray, shift: np.ndarray) -> None:
        """Give the first face of each pair the shifted mesh of the second one."""
        move = np.eye(4)
        move[:3, 3] = shift
        tags = [[self.surfaces[k] for k in side] for side in pairs.T.tolist()]
        self.model.mesh.setPeriodic(2, *tags, move.ravel().tolist())


def _read(
    mesh: Any, dim: int, tag: int, facets: list[int]
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the mesh of a block: vertices [v, d], m, cells [c, d + 1], and for each facet of cells
    the index of the block's facet [c, d + 1], or -1."""
    nodes, places, _ = mesh.getNodes(dim, tag, includeBoundary=True)
    nodes, first = np.unique(np.asarray(nodes, np.int64), return_index=True)
    x = np.asarray(places).reshape(-1, 3)[first, :dim]
    cells = _elements(mesh, KINDS[dim], dim, tag)
    each = [_elements(mesh, KINDS[dim - 1], dim - 1, one) for one in facets]
    number = np.repeat(np.arange(len(each)), list(map(len, each)))
    cells, vertices = (np.searchsorted(nodes, one) for one in (cells, np.concatenate(each)))
    return x, cells, on_facets(SIMPLICES[dim], cells, vertices, number, len(x))


def _elements(mesh: Any, kind: int, dim: int, tag: int) -> np.ndarray:
    return np.asarray(mesh.getElementsByType(kind, tag)[1], np.int64).reshape(-1, dim + 1)


def _placed(
    body: Complex,
    groups: list[Alike],
    found: Sequence[tuple[np.ndarray, np.ndarray, np.ndarray]],
    tolerance: float,
) -> Conforming:
    """Return the mesh of all blocks from the mesh of one block of each group."""
    x, cells, block, on, total = [], [], [], [], 0
    for (of, corner, facets), (places, own, facet) in zip(groups, found, strict=True):
        count, origin = len(of), body.vertices[corner]
        x.append((places + (origin - origin[0])[:, None]).reshape(-1, body.dim))
        first = total + len(places) * np.arange(count)
        cells.append((first[:, None, None] + own).reshape(-1, own.shape[1]))
        block.append(np.repeat(of, len(own)))
        beyond = np.append(facets, np.full((count, 1), -1), axis=1)
        on.append(beyond[:, facet].reshape(-1, own.shape[1]))
        total += count * len(places)
    every = np.concatenate(x)
    used, vertex = np.unique(merged(every, 10 * tolerance), return_inverse=True)
    order = np.argsort(np.concatenate(block), kind="stable")
    cells_, block_, on_ = (np.concatenate(one)[order] for one in (cells, block, on))
    cells_ = vertex.reshape(-1)[cells_]
    flat = (np.diff(np.sort(cells_, axis=1), axis=1) == 0).any(axis=1)
    if flat.any():
        at = every[used][cells_[flat.argmax()]].mean(axis=0)
        cause = f"edges shorter than {10 * tolerance:.2g} m make no elements: joints nearly meet"
        raise GeometryError(at, cause)
    return _oriented(Conforming(SIMPLICES[body.dim], every[used], cells_, block_, on_))


def own_cells(body: Complex) -> Conforming:
    """Return a complex of simplices as a mesh, one cell each."""
    half, dim = body.halves(), body.dim
    cells = body.corners(half)[:, 1].reshape(-1, dim + 1)
    number = np.arange(len(body.sides))
    vertices = body.corners_of_facets()[:, 1].reshape(-1, dim)
    on = on_facets(SIMPLICES[dim], cells, vertices, number, len(body.vertices))
    return _oriented(Conforming(SIMPLICES[dim], body.vertices, cells, np.arange(body.count), on))


def are_simplices(body: Complex) -> bool:
    """Return whether all cells of a complex are triangles or tetrahedra."""
    half = body.halves()
    each = half.cell, body.corners(half)[:, 0]  # the cell of each facet, and of each corner
    return all((np.bincount(one, minlength=body.count) == body.dim + 1).all() for one in each)


def _oriented(mesh: Conforming) -> Conforming:
    """Return a mesh of simplices with positive volumes."""
    arms = mesh.x[mesh.cells[:, 1:]] - mesh.x[mesh.cells[:, :1]]
    turned = np.linalg.det(arms) < 0
    cells, on = mesh.cells.copy(), mesh.on.copy()
    for array in (cells, on):  # facet k is the one without corner k
        array[turned, -2:] = array[turned, -2:][:, ::-1]
    return mesh._replace(cells=cells, on=on)
