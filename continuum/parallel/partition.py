"""Partition of a mesh: the cells of each process, and its part of the mesh."""

from typing import NamedTuple

import numpy as np

from jointwave.cases.errors import SceneError
from jointwave.continuum.mesh.copies import tied_together
from jointwave.continuum.mesh.description import Joints, Mesh, Part

#: Of the cells of one process: smaller copies are not divided. Many equal blocks share one
#: operator; half of a block needs its own.
WHOLE = 0.5

LAYER = 1e-6  # of the pillar: tolerance for cells at one height


class Copies(NamedTuple):
    """Copies of parts, in the order of cell numbers; arrays [copies].

    part : the part copied. first, cells : its first cell, and its number of cells.
    """

    part: np.ndarray
    first: np.ndarray
    cells: np.ndarray

    def of(self, cell: np.ndarray) -> np.ndarray:
        """Return the copies to which cells belong."""
        return np.searchsorted(self.first, cell, side="right") - 1


class Share(NamedTuple):
    """The part of a mesh on one process.

    parts : its own cells, and as ghosts those beyond its joints; complete copies are grouped, of
    others there is only the share. The material of ghosts is mesh.materials.
    cell : int array, number in the whole mesh of each cell of the parts.
    ghost : bool array, whether it is a ghost.
    joints : its own.
    """

    parts: tuple[Part, ...]
    cell: np.ndarray
    ghost: np.ndarray
    joints: Joints


def copies_of(mesh: Mesh) -> Copies:
    """Return all copies of all parts of a mesh."""
    part = np.repeat(np.arange(len(mesh.parts)), [p.copies for p in mesh.parts])
    cells = np.array([len(p.cells) for p in mesh.parts])[part]
    return Copies(part, np.cumsum(cells) - cells, cells)


def ranks_of_cells(mesh: Mesh, size: int) -> np.ndarray:
    """Return the process (of `size`) of each cell, int array [cells].

    All get the same number of cells, contiguous along the pillar, except that small copies are not
    divided. Raises SceneError if there are more processes than cells.
    """
    copies = copies_of(mesh)
    total = cells_enough(copies, size)
    queue = np.argsort(_heights(mesh), kind="stable")
    order = [_along_pillar(part) for part in mesh.parts]
    cells = np.concatenate([copies.first[c] + order[copies.part[c]] for c in queue])
    rank = np.empty(total, dtype=np.int64)
    cuts = _cuts(copies.cells[queue], size)
    rank[cells] = np.searchsorted(cuts, np.arange(total), side="right")
    return rank


def cells_enough(copies: Copies, size: int) -> int:
    """Return the number of cells; raises SceneError if there are more processes."""
    total = int(copies.cells.sum())
    if size > total:
        allowed = f"must be at most {total}, the cells of the mesh"
        raise SceneError("mpiexec", "-n", size, allowed)
    return total


def _heights(mesh: Mesh) -> np.ndarray:
    """Return the mean height of every copy [copies], m."""
    along = min(1, mesh.parts[0].x.shape[1] - 1)
    return np.concatenate(
        [part.x[part.cells, along].mean() + part.shifts[:, along] for part in mesh.parts]
    )


def _along_pillar(part: Part) -> np.ndarray:
    """Return the order of a part's cells layer by layer along the pillar, int array [cells]."""
    centre = part.x[part.cells].mean(axis=1)
    dim = centre.shape[1]
    x, y, z = (centre[:, axis] for axis in (0, min(1, dim - 1), dim - 1))
    return np.lexsort((z, x, np.rint(y / (LAYER * np.ptp(part.x)))))


def _cuts(cells: np.ndarray, size: int) -> np.ndarray:
    """Return the cuts of a sequence of copies with these numbers of cells, int array [size - 1]."""
    end, share = np.cumsum(cells), cells.sum() / size
    found = []
    for wanted in share * np.arange(1, size):
        copy = np.searchsorted(end, wanted)
        begin = end[copy] - cells[copy]
        near = begin if wanted - begin < end[copy] - wanted else end[copy]
        found.append(near if cells[copy] <= WHOLE * share else int(wanted + 0.5))
    return np.array(found, dtype=np.int64)


def restrict(mesh: Mesh, rank_of: np.ndarray, rank: int, together: bool = False) -> Share:
    """Return the share of a process, given the process of each cell, `rank_of` [cells].

    A joint's facet belongs to the process of its left cell. together : whether all cells outside
    repeated whole copies form one last part.
    """
    own, joints = rank_of == rank, mesh.joints
    mine = own[joints.left]
    held = own.copy()
    held[joints.right[mine]] = True
    parts, cell, others, of_others = [], [], [], []
    for part, numbers in zip(mesh.parts, cell_numbers(mesh), strict=True):
        is_whole = own[numbers].all(axis=1) & (part.copies > 1 or not together)
        if is_whole.any():
            parts.append(part._replace(shifts=part.shifts[is_whole]))
            cell.append(numbers[is_whole].ravel())
        for copy in np.flatnonzero(~is_whole & held[numbers].any(axis=1)):
            some = held[numbers[copy]]
            ghosts = ~own[numbers[copy][some]]
            others.append(_some_cells(part, copy, some, ghosts, mesh.materials))
            of_others.append(numbers[copy][some])
    if together and others:
        others = [_one_part(others)]
    number = np.concatenate([*cell, *of_others])
    shift = None if joints.shift is None else joints.shift[mine]
    whose = joints.joint[mine], joints.left[mine], joints.right[mine], joints.corners[mine]
    of_process = Joints(*whose, shift)
    return Share((*parts, *others), number, ~own[number], of_process)


def cell_numbers(mesh: Mesh) -> list[np.ndarray]:
    """Return the numbers of the cells of each part, int arrays [copies, cells]."""
    counts = [p.copies * len(p.cells) for p in mesh.parts]
    cells = np.split(np.arange(sum(counts)), np.cumsum(counts)[:-1])
    return [n.reshape(p.copies, -1) for n, p in zip(cells, mesh.parts, strict=True)]


def _one_part(parts: list[Part]) -> Part:
    """Return parts with one copy each as one part, at their positions."""
    sizes = [len(part.x) for part in parts]
    first = np.cumsum(sizes) - sizes
    return Part(
        np.concatenate([part.x + part.shifts[0] for part in parts]),
        np.concatenate([part.cells + n for part, n in zip(parts, first, strict=True)]),
        np.concatenate([part.material for part in parts]),
        np.zeros_like(parts[0].shifts),
        tied_together([part.tied for part in parts], first),
    )


def _some_cells(part: Part, copy: int, some: np.ndarray, ghosts: np.ndarray, ghost: int) -> Part:
    """Return some cells of a copy as a part of their own."""
    used, cells = np.unique(part.cells[some], return_inverse=True)
    if part.tied is not None:  # to vertices of cells that may be another process's
        used, cells = np.arange(len(part.x)), part.cells[some]
    return Part(
        part.x[used],
        cells.reshape(-1, part.cells.shape[1]),
        np.where(ghosts, ghost, part.material[some]),
        part.shifts[copy : copy + 1],
        part.tied,
    )
