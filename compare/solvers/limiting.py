"""The block or element that limits the explicit step of an engine, and what lifting it takes.

Every freedom i bounds the square of the highest frequency by sum |K_ij| / m_i (Gershgorin), and
every rigid block of a rock mass by the stiffness against what it touches. A part that is stiff for
its mass stands out; more mass on it lifts it.
"""

from typing import Any

import numpy as np

from jointwave.cases.scene_type import AnyScene
from jointwave.compare.solvers.dem import DEM

MOST = 0.05  # of all parts: those that are lifted
ALIKE = 1.1  # a gain in the step below which nothing stands out


def limiting(name: str, model: str | None, scene: AnyScene) -> dict[str, Any] | None:
    """Return what limits an engine's explicit step on a scene, None if its parts are much alike.

    at : its place, m. size : m, of a block the root of its area, of an element its shortest edge.
    longer_step : by how much the step grows where the twentieth of the parts that bounds it most is
    lifted to the next one. mass_added : what that adds to the whole mass, relative.
    """
    square, mass, place, size = (_blocks if name == DEM.name else _elements)(scene, model)
    order = np.argsort(square)
    first, rest = order[-1], order[-1 - int(MOST * len(order))]
    gain = float(np.sqrt(square[first] / square[rest]))
    if gain < ALIKE:
        return None
    added = float(mass @ np.maximum(square / square[rest] - 1, 0) / mass.sum())
    found = {"at": place[first].tolist(), "size": float(size(first))}
    return found | {"longer_step": gain, "mass_added": added}


def _blocks(scene: AnyScene, model: Any) -> tuple:
    """Return the squared frequencies (1/s2), masses and places of rigid blocks, and their sizes."""
    from jointwave.dem.contacts.stability import squared_frequencies
    from jointwave.dem.prepare import blocks_of

    blocks = blocks_of(scene)
    square = squared_frequencies(blocks.contacts, blocks.columns, blocks.masses)
    return square, blocks.inertia[:, 0], blocks.centroid, lambda i: blocks.size[i]


def _elements(scene: AnyScene, model: Any) -> tuple:
    """Return the same of the nodes of deformable rock with their shortest edges."""
    from jointwave.continuum.plan import plan_of
    from jointwave.continuum.space.compat import cell_corners
    from jointwave.continuum.space.evaluation import nodes_of_cells

    problem = plan_of(scene, model).problem
    body, first = problem.body, slice(None, None, problem.body.components)
    assert body.mass is not None
    mass, bound = body.mass[first], abs(problem.stiffness).sum(axis=1)
    corners, cells = cell_corners(body.mesh), nodes_of_cells(body)

    def size(node: int) -> float:
        own = corners[(cells == node).any(axis=1)][0]
        apart = np.linalg.norm(own[:, None] - own, axis=2)
        return float(apart[apart > 0].min())

    return np.asarray(bound).ravel()[first] / mass, mass, body.x, size
