"""The block or element that limits the explicit step of an engine, and what lifting it takes.

Every freedom i bounds the square of the highest frequency by sum |K_ij| / m_i (Gershgorin), and
every rigid block of a rock mass by the stiffness against what it touches. A part that is stiff for
its mass stands out; more mass on it lifts it.
"""

from typing import Any

import numpy as np

from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.schema.scene import Scene
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
    if isinstance(scene, Scene):
        from jointwave.dem.static import stiffest

        p = stiffest(scene, calibrate(scene))
        k = np.pad(p.stiffness * p.area, 1)
        mass = np.full(p.block_count, p.block_mass) if p.masses is None else p.masses
        length = np.diff(p.contact_y)
        return 2 * (k[1:] + k[:-1]) / mass, mass, p.centre_y[:, None], lambda i: length[i]
    from jointwave.dem.build import rigid_blocks
    from jointwave.dem.stability import squared_frequencies

    blocks = rigid_blocks(scene)
    square = squared_frequencies(blocks.contacts, blocks.columns, blocks.masses)
    volume, dim = blocks.cut.volume, blocks.dim
    return square, blocks.inertia[:, 0], blocks.cut.centroid, lambda i: volume[i] ** (1 / dim)


def _elements(scene: AnyScene, model: Any) -> tuple:
    """Return the same of the nodes of deformable rock with their shortest edges."""
    from jointwave.continuum.build import operators
    from jointwave.continuum.run import discrete_and_steps

    discrete, _, _ = discrete_and_steps(scene, model)
    body, stiffness = discrete.body, abs(operators(discrete)[0])
    mass = body.mass[body.first]
    square = np.asarray(stiffness.sum(axis=1)).ravel()[body.first] / mass

    def size(node: int) -> float:
        corners = body.corners[(body.cells == node).any(axis=1)][0]
        apart = np.linalg.norm(corners[:, None] - corners, axis=2)
        return float(apart[apart > 0].min())

    return square, mass, body.x, size
