"""Plane sections through rock masses in space, normal to an axis."""

from typing import Any, NamedTuple

import numpy as np
from scipy.sparse import csr_matrix

from jointwave.cases.errors import SceneError
from jointwave.cases.partition.scene import blocks_of_scene
from jointwave.cases.partition.shape import shape_of
from jointwave.compare.figures.animation.bodies import FACES
from jointwave.results.snapshots import Snapshots

BESIDE = 1e-6  # of the body's size: distance of a section from faces along it, on their larger side


class Section(NamedTuple):
    """The plane on which the coordinate `axis` (0, 1, 2) is `at`, m; beside : see BESIDE, m."""

    axis: int
    at: float
    beside: float

    @property
    def axes(self) -> list[int]:
        """The axes of the section, rightwards and upwards."""
        return [axis for axis in range(3) if axis != self.axis]

    @property
    def name(self) -> str:
        """The plane in words."""
        return f"section {'xyz'[self.axis]} = {self.at:g} m"

    def heights(self, points: np.ndarray) -> np.ndarray:
        """Return the heights of points [..., 3] above the section, m."""
        return points[..., self.axis] - (self.at + self.beside)


def section_of(scene: Any, words: str | None) -> Section:
    """Return the section of a rock mass in space that is written as "y=25".

    None: normal to y, through the middle of the openings or else the front. Raises SceneError.
    """
    shape = shape_of(scene.domain)
    axis, at = 1, middle_of_openings(scene)
    if words is not None:
        name, _, place = words.partition("=")
        try:
            axis, at = list("xyz").index(name.strip()), float(place)
        except ValueError:
            allowed = 'must be an axis and a place in m, as "y=25"'
            raise SceneError(scene.title, "section", words, allowed) from None
    low, high, beside = shape.low[axis], shape.high[axis], BESIDE * shape.size
    at = float(low) if at is None else at
    if not low <= at <= high:
        allowed = f"must be from {low:g} to {high:g} m"
        raise SceneError(scene.title, "section", words, allowed)
    return Section(axis, at, beside if at < high - 2 * beside else -beside)


def middle_of_openings(scene: Any) -> float | None:
    """Return the mean y of the corners of all openings, m; None without."""
    walls = [corners for one, _ in shape_of(scene.domain).solids for corners, _ in one.faces()]
    walls += scene.domain.holes if scene.domain.given is not None else []
    return float(np.concatenate(walls)[:, 1].mean()) if walls else None


def cut_cells(s: Snapshots, section: Section) -> Snapshots:
    """Return snapshots on the section: triangles between the lines on which it cuts the faces of a
    cell, or the surface of a block, and the mean of these lines. Motion is linear along edges.
    Raises SceneError where it meets no rock."""
    rings = np.array(FACES[s.kind])
    nodes = s.cells[:, rings].reshape(-1, rings.shape[1])
    following = np.roll(np.arange(nodes.size).reshape(nodes.shape), -1, axis=1).ravel()
    at, share = _crossings(section.heights(s.points)[nodes.ravel()], following)
    if not at.size:
        raise SceneError(section.name, "", None, "meets no rock")
    ends, cell = nodes.ravel()[np.stack([at, following[at]])], at[::2] // rings.size
    body = s.block[cell] if s.kind == "triangle" else cell  # of rigid blocks only the surface
    centre = np.unique(body, return_inverse=True)[1]
    lines = csr_matrix((np.ones(len(at)), (np.repeat(centre, 2), np.arange(len(at)))))
    lines = lines.multiply(1 / lines.sum(axis=1)).tocsr()

    def of(values: np.ndarray) -> np.ndarray:
        """Return values of nodes [nodes, 3] at the ends of the lines, then at their means."""
        found = _between(values, ends, share)
        return np.concatenate([found, lines @ found])

    of_lines = np.arange(len(at)).reshape(-1, 2)
    return Snapshots(
        s.time,
        of(s.points),
        "triangle",
        np.column_stack([of_lines, len(at) + centre]),
        s.block[cell],
        np.stack(list(map(of, s.displacement))),
        np.stack(list(map(of, s.velocity))),
        None if s.stress is None else s.stress[:, cell],
    )


def cut_joints(scene: Any, section: Section) -> tuple[np.ndarray, np.ndarray]:
    """Return where joints meet the section: the ends of lines [n, 2, 2] (right, up), m, and the
    unit normals of their joints [n, 3]."""
    contacts = blocks_of_scene(scene).contacts
    corners, first = contacts.outlines
    following = np.arange(1, len(corners) + 1)
    following[first[1:] - 1] = first[:-1]
    at, share = _crossings(section.heights(corners), following)
    ends = _between(corners, np.stack([at, following[at]]), share)[:, section.axes]
    contact = np.searchsorted(first, at[::2], side="right") - 1
    joint = contacts.joint_set[contact] >= 0
    return ends.reshape(-1, 2, 2)[joint], contacts.normal[contact[joint]]


def _crossings(height: np.ndarray, following: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the corners before the edges of faces that cross height 0, two a face or none, and
    where each crosses as a share of its length. following : the next corner of each corner."""
    low, high = height, height[following]
    at = np.flatnonzero(low * high < 0)
    return at, low[at] / (low[at] - high[at])


def _between(values: np.ndarray, ends: np.ndarray, share: np.ndarray) -> np.ndarray:
    """Return values at a share [n] of the way between pairs of nodes [2, n]."""
    low, high = values[ends]
    return low + share[:, None] * (high - low)
