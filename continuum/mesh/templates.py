"""Meshes of single blocks: quadrilaterals between four edges, or triangles in any polygon.

The nodes of a template are those on its boundary, counter-clockwise from its first corner,
followed by those inside.
"""

from typing import NamedTuple

import numpy as np

from jointwave.continuum.body.session import gmsh_session


class Template(NamedTuple):
    """The mesh of a block.

    cells : int array [cells, corners] in basix's order. inside : of the n nodes inside,
    weights of the block's corners [n, corners] or places from the first corner [n, 2], m.
    """

    cells: np.ndarray
    inside: np.ndarray

    def placed(self, corners: np.ndarray) -> np.ndarray:
        """Return the nodes inside [blocks, n, 2], m, of blocks whose segments begin at `corners`
        [blocks, k, 2]."""
        if self.cells.shape[1] == 4:
            return np.einsum("nk,bkd->bnd", self.inside, corners)
        return corners[:, :1] + self.inside


#: Template of a triangle that is one cell.
ONE = Template(np.array([[0, 1, 2]]), np.zeros((0, 2)))


def quadrilaterals(m: int, n: int) -> Template:
    """Return m times n quadrilaterals between four edges, the first of them divided into m."""
    grid = np.full((m + 1, n + 1), -1)
    i, j = np.arange(m), np.arange(n)
    grid[i, 0], grid[m, j] = i, m + j
    grid[m - i, n], grid[0, n - j] = m + n + i, 2 * m + n + j
    free = grid < 0
    grid[free] = 2 * (m + n) + np.arange(free.sum())
    cells = np.stack([grid[:-1, :-1], grid[1:, :-1], grid[:-1, 1:], grid[1:, 1:]], axis=-1)
    s, t = (
        axis[free] for axis in np.meshgrid(*(np.arange(k + 1) / k for k in (m, n)), indexing="ij")
    )
    shares = np.stack([(1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t], axis=1)
    return Template(cells.swapaxes(0, 1).reshape(-1, 4), shares)


def triangles(shapes: list[tuple[np.ndarray, np.ndarray]], size: float) -> list[Template]:
    """Return the triangles in polygons, each given by its corners [k, 2] (m, counter-clockwise)
    and the number of triangle edges on each of its sides [k]; size : of triangles, m."""
    with gmsh_session() as gmsh:
        gmsh.option.setNumber("Geometry.AutoCoherence", 0)
        gmsh.option.setNumber("Mesh.MeshSizeMax", size)
        drawn = [_drawn(gmsh, corners, counts) for corners, counts in shapes]
        gmsh.model.geo.synchronize()
        gmsh.model.mesh.generate(2)
        return [_read(gmsh, *one, shape[0][0]) for one, shape in zip(drawn, shapes, strict=True)]


def _drawn(gmsh, corners: np.ndarray, counts: np.ndarray) -> tuple[list[int], list[int], int]:
    """Add a polygon to gmsh, and return the tags of its corners, sides and interior."""
    geo = gmsh.model.geo
    points = [geo.addPoint(x, y, 0.0) for x, y in corners - corners[0]]
    lines = [geo.addLine(*pair) for pair in zip(points, points[1:] + points[:1], strict=True)]
    for line, count in zip(lines, counts.tolist(), strict=True):
        geo.mesh.setTransfiniteCurve(line, count + 1)
    return points, lines, geo.addPlaneSurface([geo.addCurveLoop(lines)])


def _read(gmsh, points, lines, surface, origin) -> Template:
    """Return the mesh of a polygon."""
    mesh, boundary = gmsh.model.mesh, []
    for point, line in zip(points, lines, strict=True):
        tags, _, along = mesh.getNodes(1, line)
        boundary += [*mesh.getNodes(0, point)[0], *np.array(tags)[np.argsort(along)]]
    tags, x, _ = mesh.getNodes(2, surface)
    every = np.concatenate([boundary, tags]).astype(np.int64)
    number = np.empty(every.max() + 1, dtype=np.int64)
    number[every] = np.arange(every.size)
    (corners,) = mesh.getElements(2, surface)[2]
    cells = number[np.array(corners).astype(np.int64)].reshape(-1, 3)
    return Template(cells, np.array(x).reshape(-1, 3)[:, :2])
