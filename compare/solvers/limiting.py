"""The block or element that limits the explicit time step of an engine, and the cost of relieving
it.

The sum |K_ij| / m_i of degree of freedom i bounds the square of the highest frequency (Gershgorin),
and so does a rigid block's contact stiffness over its mass. A part that is stiff for its mass
stands out; added mass relieves it.
"""

from typing import Any

import numpy as np

from jointwave.cases.scene_type import AnyScene
from jointwave.compare.solvers.dem import DEM

MOST = 0.05  # share of parts that are relieved
ALIKE = 1.1  # gain in the time step below which nothing stands out


def limiting(name: str, model: str | None, scene: AnyScene) -> dict[str, Any] | None:
    """Return what limits an engine's explicit step on a scene; None if its parts are similar.

    at : place, m. size : m, of a block the root of its area, of an element its shortest edge.
    longer_step : gain in the step if the most limiting twentieth of the parts is raised to the next
    one. mass_added : by that, relative to the whole mass.
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
    """Return the squared frequencies (1/s2), masses, places and sizes of rigid blocks."""
    from jointwave.dem.contacts.stability import squared_frequencies
    from jointwave.dem.prepare import blocks_of

    blocks = blocks_of(scene)
    square = squared_frequencies(blocks.contacts, blocks.columns, blocks.masses)
    return square, blocks.inertia[:, 0], blocks.centroid, lambda i: blocks.size[i]


def _elements(scene: AnyScene, model: Any) -> tuple:
    """Return the same for the nodes of deformable rock, with their shortest edges."""
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
