"""Snapshots of deformable rock: its nodes, and linear cells between them."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from scipy.sparse import csr_matrix

from jointwave.cases.schema.rock_mass import RockMass
from jointwave.cases.schema.scene import Scene
from jointwave.continuum.build import Discrete
from jointwave.continuum.parallel.serial import Pieces
from jointwave.continuum.plane.discrete import stress_of
from jointwave.continuum.plane.recovery import COMPONENTS
from jointwave.continuum.space import basix_versions
from jointwave.continuum.space.body import axis
from jointwave.continuum.space.elasticity import elastic_moduli
from jointwave.continuum.space.evaluation import at_reference, matrix_of
from jointwave.continuum.space.receivers import section_tractions
from jointwave.continuum.state import State
from jointwave.results.snapshots import SnapshotRecorder, Snapshots, snapshots, with_snapshots
from jointwave.results.subcells import KINDS, linear_cells


class RockRecorder(SnapshotRecorder):
    """The rock at every snapshot of a scene; raises SceneError for too many.

    ahead : s, how far the displacements of the state are beyond the step of a sample.
    """

    def __init__(self, scene: Scene | RockMass, discrete: Any, state: State, ahead: float) -> None:
        body = discrete.body
        self.cell = np.flatnonzero(body.cells[:, 0] >= 0)
        self.nodes, numbers = np.unique(body.cells[self.cell], return_inverse=True)
        self.table = numbers.reshape(self.cell.size, -1)
        self.parts = linear_cells(
            body.mesh.cell, basix_versions.reference_element(body.mesh.cell, body.order).points
        )
        self.axial = isinstance(scene, Scene)
        most = (
            self.nodes.size
            if self.axial
            else max(self.nodes.size, self.table[:, 0].size * len(self.parts))
        )
        super().__init__(scene, int(body.communicator.sum(most)), self.frame)
        self.discrete, self.state, self.ahead = discrete, state, ahead
        self.freedoms = body.freedom(self.nodes[:, None], np.arange(body.section.components))
        self.stress = stress_of_cells(discrete, self.cell, self.parts, self.axial)
        if isinstance(scene, Scene):
            self.prestress = np.array([scene.prestress.normal if scene.prestress else 0.0])
        else:
            self.prestress = stress_of(scene)

    def frame(self, sample: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return displacement, velocity of the nodes and stress of the cells at this sample, whose
        step has just been taken."""
        state = self.state
        u = state.u - self.ahead * state.v
        v = (state.v + state.v_before) / 2
        strained = u if state.strained is None else state.strained
        stress = (self.stress @ strained).reshape(self.prestress.size, -1).T + self.prestress
        return u[self.freedoms], v[self.freedoms], stress[:, 0] if self.axial else stress

    def add_to(self, result: xr.Dataset) -> xr.Dataset:
        """Return the run's result with its snapshots, which the first process alone has."""
        body = self.discrete.body
        u, v, stress = (np.stack(column, axis=1) for column in zip(*self.frames, strict=True))
        of_cells = (stress.reshape(self.cell.size, len(self.parts), *stress.shape[1:]),)
        u -= 0.0 if self.axial else u[:, :1]  # of a rock mass it counts from the start
        own = Pieces(self.cell, self.table, of_cells, (body.x[self.nodes], u, v))
        whole = body.communicator.joined(own)
        return result if whole is None else with_snapshots(result, self._of_all(result, whole))

    def _of_all(self, result: xr.Dataset, whole: Pieces) -> Snapshots:
        """Return the snapshots of the whole body."""
        x, u, v = whole.of_nodes
        cells = whole.table[:, self.parts].reshape(-1, self.parts.shape[1])
        time = result["time"].values[:: self.every][: u.shape[1]]
        (stress,) = (of.reshape(len(cells), *of.shape[2:]) for of in whole.of_cells)
        u, v, stress = (np.ascontiguousarray(np.moveaxis(a, 1, 0)) for a in (u, v, stress))
        if self.axial:
            height = x[cells, axis(x.shape[1])].mean(axis=1)
            block = np.searchsorted(self.discrete.properties.contact_y, height) - 1
        else:
            block = np.repeat(self.discrete.block, len(self.parts))
        return snapshots(time, x, KINDS[self.discrete.body.mesh.cell], cells, block, u, v, stress)


def stress_of_cells(
    discrete: Discrete, cells: np.ndarray, parts: np.ndarray, axial: bool
) -> csr_matrix:
    """Return the stress (compression positive) at the centres of the linear cells of cells, from
    the freedoms: [cells * parts, freedoms] along a pillar; of a rock mass xx of all, yy and xy."""
    body = discrete.body
    nodes = basix_versions.reference_element(body.mesh.cell, body.order).points
    centres = nodes[parts].mean(axis=1)
    cell = np.repeat(cells, len(parts))
    point = at_reference(body, cell, np.tile(centres, (cells.size, 1)))
    if axial:
        weights = -section_tractions(body, discrete.materials, point)[:1]
    else:
        moduli = np.array([elastic_moduli(material, 2, 2) for material in discrete.materials])
        of_stress = np.stack([moduli[body.material[cell], i, j] for i, j in COMPONENTS])
        weights = -np.einsum("dncj,nkj->dnkc", of_stress, point.gradient)
    return matrix_of(body, np.arange(cell.size), cell, weights, cell.size)
