"""Snapshots of a body: its nodes, and linear cells between them."""

import numpy as np

from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.run_memory import refuse_beyond_memory, snapshot_bytes
from jointwave.cases.scene_type import AnyScene
from jointwave.continuum.mesh.conforming import SIMPLEX
from jointwave.continuum.scene import SceneBody
from jointwave.continuum.space import compat, evaluation
from jointwave.continuum.stepping.implicit import Implicit
from jointwave.continuum.stepping.leapfrog import Leapfrog
from jointwave.results.snapshots import Frame, SnapshotRecorder
from jointwave.results.stress import stress_components
from jointwave.results.subcells import KINDS, linear_cells


class StressOfCells:
    """Stress at the centres of the linear subcells of cells.

    slopes : of the shape functions there, in the reference cell [parts, nodes, d]. inverse : dX/dx
    there [cells, parts, d, d], 1/m. moduli : n components of the stress per displacement gradient,
    compression positive [cells, n, components, d], Pa. lag : time constant of the rock's dashpots
    [cells, 1, 1], s; None without. constant : stress at u = 0 [n], Pa.
    """

    def __init__(self, found: SceneBody, parts: np.ndarray, points: np.ndarray) -> None:
        body, kind = found.body, found.body.cell.kind
        self.nodes, corners = evaluation.nodes_of_cells(body), compat.cell_corners(body.mesh)
        self.size, centres = body.components, points[parts].mean(axis=1)
        self.slopes = evaluation.tabulate(body.cell.element, centres)[1]
        at = np.tile(centres, (len(corners), 1))
        each = np.repeat(corners, len(parts), axis=0)
        shape = len(corners), len(parts), *2 * (corners.shape[2],)
        self.inverse = np.linalg.inv(evaluation.jacobians(kind, each, at)).reshape(shape)
        axes = len(found.scene.axes)
        pairs = [*stress_components(axes).values()] if axes > 1 else [(1, 1)]
        self.moduli, lag = -found.moduli(pairs)[found.of_cell], found.of_cells("time_constant")
        self.lag = lag[:, None, None] if lag.any() else None
        given = found.scene.prestress
        self.constant = np.array([0.0 if given is None else given.tensor[one] for one in pairs])

    def of(self, u: np.ndarray, v: np.ndarray) -> np.ndarray:
        """Return the stress [cells * parts, n], Pa, from displacement and velocity [freedoms]."""
        moved = u.reshape(-1, self.size)[self.nodes]
        if self.lag is not None:
            moved = moved + self.lag * v.reshape(-1, self.size)[self.nodes]
        gradient = np.einsum("kni,pne->kpie", moved, self.slopes, optimize=True) @ self.inverse
        found = np.einsum("ksij,kpij->kps", self.moduli, gradient, optimize=True)
        return found.reshape(-1, found.shape[2]) + self.constant


class RockRecorder(SnapshotRecorder):
    """Records the rock at every snapshot; raises SceneError for too many or too large ones.

    steps : must have just taken the step of a sample when it is recorded.
    """

    def __init__(self, scene: AnyScene, found: SceneBody, steps: Leapfrog | Implicit) -> None:
        self.found, self.steps, body = found, steps, found.body
        kind, nodes = body.cell.kind, compat.cell_nodes(body.space)
        points = body.cell.element.points
        own = np.arange(len(points))
        if kind in SIMPLEX and body.cell.order == 2:  # a full lattice, without bubble nodes
            own = np.flatnonzero(np.isclose(2 * points, np.rint(2 * points)).all(axis=1))
        parts = linear_cells(kind, points[own])
        self.stress = StressOfCells(found, parts, points[own])
        self.node, first, number = np.unique(nodes[:, own], return_index=True, return_inverse=True)
        points = evaluation.places_of_nodes(body)[:, own].reshape(-1, body.x.shape[1])[first]
        cells = number.reshape(-1, len(own))[:, parts].reshape(-1, parts.shape[1])
        block = np.repeat(body.block, len(parts))
        if scene.is_column:  # cells of a layer belong to the adjacent blocks
            height = points[cells][..., points.shape[1] // 2].mean(axis=1)
            block = np.searchsorted(calibrate(scene).contact_y, height) - 1
        count, values = len(self.node), len(cells) * len(self.stress.constant)
        size = snapshot_bytes(scene, count, 6 + values / count)
        refuse_beyond_memory(scene, {"record.fields": size})
        shown = points, KINDS[kind], cells, block
        super().__init__(scene, max(count, values // 3), shown, self.frame)

    def frame(self, sample: int) -> Frame:
        """Return displacement and velocity of the nodes, stress of the cells, and no slip."""
        (u, v, strained), body = self.steps.last, self.found.body
        node = self.node if body.tied is None else body.tied[self.node]
        moved, moving = (one.reshape(-1, body.components)[node] for one in (u, v))
        stress = self.stress.of(strained, v)
        return moved, moving, stress[:, 0] if stress.shape[1] == 1 else stress, np.zeros(0)
