"""The complex of faces of blocks: edges split at the vertices on them, each facet there once."""

from collections import defaultdict
from itertools import pairwise

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from jointwave.cases.geometry.block_faces import Face, near, steps, vector_areas
from jointwave.cases.geometry.cell_complex import OUTSIDE, PARALLEL, Complex
from jointwave.cases.geometry.read_blocks import Loop, Loops
from jointwave.cases.gmsh_file import MeshError

GENERIC = np.array([0.5488, 0.7152, 0.4332])  # what normals of one direction are turned towards


def merged(x: np.ndarray, tolerance: float) -> tuple[np.ndarray, np.ndarray]:
    """Return points with those within the tolerance (m) of others replaced by the first of them,
    and the number of each one's first."""
    places, first, which = np.unique(x, axis=0, return_index=True, return_inverse=True)
    pairs = cKDTree(places).query_pairs(tolerance, output_type="ndarray")
    group = joined(pairs, len(places))
    least = np.full(len(places), len(x))
    np.minimum.at(least, group, first)
    number = least[group][which.reshape(-1)]
    return x[number], number


def joined(pairs: np.ndarray, number: int) -> np.ndarray:
    """Return the group of each of a number of things that pairs [m, 2] connect."""
    one, other = np.reshape(pairs, (-1, 2)).T.astype(np.int64)
    return connected_components(coo_array((np.ones(len(one)), (one, other)), (number, number)))[1]


def assembled(faces: list[Face], x: np.ndarray, names: list[str], tolerance: float) -> Complex:
    """Return the complex of faces; x : the blocks' corners, which those of faces that are within
    the tolerance become; names : of the blocks."""
    dim = x.shape[1]
    x, number = merged(np.concatenate([x, *(face.corners for face in faces)]), tolerance)
    ends = np.cumsum([len(face.corners) for face in faces])
    loops = [one.tolist() for one in np.split(number[-ends[-1] :], ends[:-1])]
    held: dict[frozenset, list[tuple[Loop, int]]] = defaultdict(list)
    for k, whole in enumerate(_with_vertices(x, loops, tolerance)):
        for loop in [whole] if dim == 3 else map(list, pairwise(whole)):
            if len(loop) >= dim:
                held[frozenset(loop)].append((loop, k))
    halves = [(f, k, loop) for f, own in enumerate(held.values()) for loop, k in own]
    facet, face = (np.array([one[k] for one in halves]) for k in (0, 1))
    first = np.diff(facet, prepend=-1) > 0
    last = np.append(first[1:], True)
    cell, joint, plane = (np.array([one[k] for one in faces])[face] for k in (1, 2, 3))
    if not (first | last).all():
        at = x[halves[np.argmin(first | last)][2]]
        raise MeshError(f"more than two of its blocks share a face{near(at)}")
    half = np.repeat(np.arange(len(halves)), [len(loop) for *_, loop in halves])
    start, end = np.array([edge for *_, loop in halves for edge in steps(loop)]).T
    edges, edge = np.unique(np.sort([start, end], axis=0).T, axis=0, return_inverse=True)
    ridge = start if dim == 2 else edge.reshape(-1)
    forth = np.diff(half, prepend=-1) > 0 if dim == 2 else start < end
    _check_closed(cell[half], ridge, forth, x[start], names)
    mine = first[half]
    bounds = [np.stack([facet[half], ridge], axis=1)[mine]]
    if dim == 3:
        bounds.insert(0, np.stack([np.repeat(np.arange(len(edges)), 2), edges.ravel()], axis=1))
    used, vertex = np.unique(bounds[0][:, 1], return_inverse=True)
    bounds[0][:, 1] = vertex.reshape(-1)
    links = np.stack([plane[first], plane[last]], axis=1)
    area = vector_areas(x[start], np.bincount(half))
    normals, plane, into = _planes(area, plane, links)
    sides = np.stack([cell[first], np.where(first & last, OUTSIDE, cell)[last]], axis=1)
    return Complex(
        vertices=x[used],
        bounds=tuple(bounds),
        sides=np.where(into[first, None], sides[:, ::-1], sides),
        plane=plane[first],
        joint_set=np.maximum(joint[first], joint[last]),
        side=np.zeros(len(sides), np.int64),
        normals=normals,
        region=np.full(len(names), -1),
        count=len(names),
    )


def _with_vertices(x: np.ndarray, loops: Loops, tolerance: float) -> Loops:
    """Return outlines (in the plane edges) by their vertices, with those of others on the way."""
    edges = {tuple(sorted(edge)) for one in loops for edge in steps(one) if edge[0] != edge[1]}
    one, other = np.array(list(edges)).T
    used = np.unique([one, other])
    along = x[other] - x[one]
    length = np.linalg.norm(along, axis=1)
    found = cKDTree(x[used]).query_ball_point((x[one] + x[other]) / 2, length / 2)
    edge = np.repeat(np.arange(len(one)), [len(near) for near in found])
    vertex = used[np.concatenate(found).astype(np.int64)]
    away = x[vertex] - x[one[edge]]
    t = (away * along[edge]).sum(axis=1) / length[edge] ** 2
    close = np.linalg.norm(away - t[:, None] * along[edge], axis=1) <= tolerance
    close &= (vertex != one[edge]) & (vertex != other[edge])
    between: dict[tuple[int, int], list[int]] = defaultdict(list)
    for k in np.flatnonzero(close)[np.argsort(t[close], kind="stable")]:
        between[one[edge[k]], other[edge[k]]].append(int(vertex[k]))
    return [
        [v for a, b in steps(loop) if a != b for v in (a, *_way(between, a, b))]
        if x.shape[1] == 3
        else [loop[0], *_way(between, *loop), loop[1]]
        for loop in loops
    ]


def _way(between: dict[tuple[int, int], list[int]], a: int, b: int) -> list[int]:
    """Return the vertices on the way from one vertex to another."""
    return between.get((a, b), []) if a < b else between.get((b, a), [])[::-1]


def _planes(
    area: np.ndarray, plane: np.ndarray, links: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return normals [l, d], no two of them parallel, the one of each facet, and whether it points
    into the facet's block. area : vector areas [n, d]; plane : number of each facet's; links :
    pairs of planes that are one, which the largest facet gives the normal."""
    which = joined(links, plane.max() + 1)[plane]
    size = np.linalg.norm(area, axis=1)
    largest = np.zeros(which.max() + 1, np.int64)
    largest[which[np.argsort(size)]] = np.argsort(size)
    normals = area[largest] / size[largest, None]
    normals *= np.where(normals @ GENERIC[: area.shape[1]] < 0, -1.0, 1.0)[:, None]
    normals, number = merged(normals, PARALLEL)
    used, found = np.unique(number[which], return_inverse=True)
    return normals[used], found.reshape(-1), (area * normals[number[which]]).sum(axis=1) < 0


def _check_closed(
    cell: np.ndarray, ridge: np.ndarray, forth: np.ndarray, x: np.ndarray, names: list[str]
) -> None:
    """Raise MeshError unless each block has each of its edges once forth and once back. Of each
    half of an edge the block, the edge, its sense and a point x [n, d]; names : of the blocks."""
    key = cell * (ridge.max() + 1) + ridge
    _, which, times = np.unique(key, return_inverse=True, return_counts=True)
    wrong = (times != 2) | (np.bincount(which.reshape(-1), weights=forth) != 1)
    if wrong.any():
        k = int(np.argmax(wrong[which.reshape(-1)]))
        raise MeshError(f"{names[cell[k]]} is open{near(x[k : k + 1])}")
