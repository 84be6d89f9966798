"""A user's gmsh file as a rock mass: its cells are the blocks, its groups the joints.

Physical groups whose names start with "rock" hold the cells, all triangles or all quadrilaterals;
"joint NAME" the edges of the joint set NAME, at any angle and in any shape, which may end inside
the rock. At a joint vertices may be there once or twice. Outline and openings are where cells end.
"""

from pathlib import Path
from typing import NamedTuple

import numpy as np

from jointwave.cases.geometry.cell_complex import NO_SET, OUTSIDE, PARALLEL, Complex
from jointwave.cases.gmsh_file import MeshError, read_tagged

PREFIX = "joint"
SAME = 1e-9  # of the mesh: vertices that are one
AROUND = [0, 1, 3, 2]  # the corners of a quadrilateral, which come in the order of a tensor product


class GivenRock(NamedTuple):
    """The cells of a file, and the edges between them.

    points : float array [p, 2], m. ends : int array [e, 2], points of each edge. cells : int array
    [e, 2], the cells to its left and right, or OUTSIDE. number : of cells.
    loops : edges around the rock, int arrays, those of the outline first, then of each opening.
    joints : the edges of each joint, int arrays by the name of its set in small letters.
    """

    points: np.ndarray
    ends: np.ndarray
    cells: np.ndarray
    number: int
    loops: list[np.ndarray]
    joints: dict[str, np.ndarray]

    @property
    def outlines(self) -> list[list[list[float]]]:
        """Corners of the outline and then of each opening, m."""
        return [self.points[self.ends[loop, 0]].tolist() for loop in self.loops]


def read_rock(path: Path) -> GivenRock:
    """Return the rock of a file; raises MeshError, in one phrase, if it contains none."""
    tagged = read_tagged(path)
    if tagged.kind not in ("triangle", "quadrilateral"):
        raise MeshError(f"its rock has {tagged.kind} cells, must have two-dimensional ones")
    flat = tagged.x[:, :2]
    grid = SAME * np.ptp(flat[tagged.cells], axis=(0, 1)).max()
    _, first, number = np.unique(
        np.rint(flat / grid), axis=0, return_index=True, return_inverse=True
    )
    points, number = flat[first], number.reshape(-1)
    cells = tagged.cells if tagged.kind == "triangle" else tagged.cells[:, AROUND]
    cells = _counter_clockwise(points, number[cells], cells)
    ends, of_edge, edge = _edges(number[cells])
    joints = {
        name[len(PREFIX) :].strip(" _-:"): _edges_of(number[facets], ends)
        for name, facets in tagged.facets.items()
        if name.startswith(PREFIX)
    }
    _check(points[ends], of_edge, joints, _doubled(cells, edge, len(ends)))
    return GivenRock(points, ends, of_edge, len(cells), _loops(points, ends, of_edge), joints)


def _counter_clockwise(points: np.ndarray, merged: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """Return cells with their corners counter-clockwise; raises MeshError for one that is not
    convex or has no area."""
    x = points[merged]
    along = np.roll(x, -1, axis=1) - x
    turn = along[..., 0] * np.roll(along[..., 1], -1, axis=1)
    turn -= along[..., 1] * np.roll(along[..., 0], -1, axis=1)
    bad = ~((turn > 0).all(axis=1) | (turn < 0).all(axis=1))
    if bad.any():
        raise MeshError(f"{bad.sum()} of its cells are flat or not convex{_near(x[bad][0])}")
    return np.where((turn < 0).all(axis=1)[:, None], cells[:, ::-1], cells)


def _edges(cells: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the edges of cells: their ends, with the first of their cells on the left; the cells
    on both sides; and which edge each side of each cell is [cells, sides]."""
    sides = np.stack([cells, np.roll(cells, -1, axis=1)], axis=2).reshape(-1, 2)
    _, first, edge, times = np.unique(
        np.sort(sides, axis=1), axis=0, return_index=True, return_inverse=True, return_counts=True
    )
    if times.max() > 2:
        raise MeshError("some of its cells overlap: more than two share an edge")
    edge, cell = edge.reshape(-1), np.repeat(np.arange(len(cells)), cells.shape[1])
    of_edge = np.full((len(first), 2), OUTSIDE)
    of_edge[:, 0] = cell[first]
    second = np.setdiff1d(np.arange(len(sides)), first)
    of_edge[edge[second], 1] = cell[second]
    if (sides[first[edge[second]], 0] == sides[second, 0]).any():
        raise MeshError("some of its cells overlap: two lie on the same side of an edge")
    return sides[first], of_edge, edge.reshape(cells.shape)


def _edges_of(facets: np.ndarray, ends: np.ndarray) -> np.ndarray:
    """Return the edges of facets, given by their points [k, 2]."""
    both = np.sort(np.concatenate([ends, facets]), axis=1)
    _, first, which = np.unique(both, axis=0, return_index=True, return_inverse=True)
    found = np.unique(first[which.reshape(-1)[len(ends) :]])
    if (found >= len(ends)).any():
        raise MeshError("edges of its joints belong to no rock cell")
    return found


def _doubled(cells: np.ndarray, edge: np.ndarray, count: int) -> np.ndarray:
    """Return which edges have vertices of the file that differ from cell to cell, bool array."""
    sides = np.sort(np.stack([cells, np.roll(cells, -1, axis=1)], axis=2), axis=2).reshape(-1, 2)
    low, high = np.full((count, 2), cells.max()), np.zeros((count, 2), dtype=np.int64)
    np.minimum.at(low, edge.ravel(), sides)
    np.maximum.at(high, edge.ravel(), sides)
    return (low != high).any(axis=1)


def _check(x: np.ndarray, cells: np.ndarray, joints: dict, doubled: np.ndarray) -> None:
    """Raise MeshError if a joint is on the outside, or if rock is cut where there is no joint."""
    on_joint = np.zeros(len(x), dtype=bool)
    for edges in joints.values():
        on_joint[edges] = True
    outside = on_joint & (cells[:, 1] == OUTSIDE)
    if outside.any():
        raise MeshError(
            f"{outside.sum()} edges of its joints are on its boundary{_near(x[outside][0])}"
        )
    loose = doubled & ~on_joint
    if loose.any():
        raise MeshError(
            f"{loose.sum()} edges coincide with others and are in no group "
            f"'joint ...'{_near(x[loose][0])}"
        )


def _near(x: np.ndarray) -> str:
    return ", the first near [{:.6g}, {:.6g}]".format(*x.mean(axis=0))


def _loops(points: np.ndarray, ends: np.ndarray, cells: np.ndarray) -> list[np.ndarray]:
    """Return the edges around the rock, loop by loop: the outline, then openings from left to
    right."""
    outer = np.flatnonzero(cells[:, 1] == OUTSIDE)
    if np.unique(ends[outer, 0]).size < outer.size:
        raise MeshError("its outline touches itself")
    following = dict(zip(ends[outer, 0].tolist(), outer.tolist(), strict=True))
    found: list[np.ndarray] = []
    while following:
        loop: list[int] = [following.pop(next(iter(following)))]
        while (edge := following.pop(int(ends[loop[-1], 1]), None)) is not None:
            loop.append(edge)
        found.append(np.array(loop))
    areas = []
    for edges in found:
        x, y = points[ends[edges, 0]].T
        areas.append(float(x @ np.roll(y, -1) - y @ np.roll(x, -1)))
    if sum(area > 0 for area in areas) != 1:
        raise MeshError("its rock is in separate pieces")
    leftmost = [points[ends[loop, 0]].min(axis=0).tolist() for loop in found]
    order = sorted(range(len(found)), key=lambda k: (areas[k] < 0, leftmost[k]))
    return [found[k] for k in order]


def complex_of(rock: GivenRock, names: list[str]) -> Complex:
    """Return the cells of a file as a complex; names : of the joint sets, in their order."""
    along = rock.points[rock.ends[:, 1]] - rock.points[rock.ends[:, 0]]
    joint_set, side = np.full(len(along), NO_SET), np.zeros(len(along), dtype=np.int64)
    for k, name in enumerate(names):
        joint_set[rock.joints.get(name.lower(), [])] = k
    for k, loop in enumerate(rock.loops):
        side[loop] = k
    right = np.stack([along[:, 1], -along[:, 0]], axis=1) / np.hypot(*along.T)[:, None]
    turned = (right[:, 0] < -PARALLEL) | ((np.abs(right[:, 0]) <= PARALLEL) & (right[:, 1] < 0))
    normals = np.where(turned[:, None], -right, right)
    _, first, plane = np.unique(
        np.rint(normals / PARALLEL), axis=0, return_index=True, return_inverse=True
    )
    edge = np.repeat(np.arange(len(along)), 2)
    return Complex(
        vertices=rock.points,
        bounds=(np.stack([edge, rock.ends.ravel()], axis=1),),
        sides=np.where(turned[:, None], rock.cells[:, ::-1], rock.cells),
        plane=plane.reshape(-1),
        joint_set=joint_set,
        side=side,
        normals=normals[first],
        region=np.full(rock.number, -1),
        count=rock.number,
    )
