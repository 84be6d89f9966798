"""Snapshots of deformable rock: its nodes, and linear cells between them."""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_matrix

from cases.result import Fields
from cases.scene import Scene
from cases.snapshots import Film, refuse_beyond_room, samples_between, snapshots, with_snapshots
from cases.subcells import KINDS, linear_cells
from continuum import compat
from continuum.build import Discrete
from continuum.model import State
from continuum.places import at_reference, matrix_of
from continuum.receivers import section_tractions


class RockFilm(Film):
    """The rock at every snapshot that a scene asks for; raises SceneError for too many.

    ahead : s, how far the displacements of the state are beyond the step of a sample.
    """

    def __init__(self, scene: Scene, discrete: Discrete, state: State, ahead: float) -> None:
        body = discrete.body
        refuse_beyond_room(scene, len(body.x))
        super().__init__(samples_between(scene) or 1, self.shot)
        self.discrete, self.state, self.ahead = discrete, state, ahead
        self.freedoms = body.freedom(
            np.arange(len(body.x))[:, None], np.arange(body.section.components)
        )
        self.parts = linear_cells(
            body.mesh.cell, compat.reference_element(body.mesh.cell, body.order).points
        )
        self.stress = axial_stress(discrete, self.parts)
        self.prestress = scene.prestress.normal if scene.prestress else 0.0

    def shot(self, sample: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return displacement, velocity of the nodes and stress of the cells at this sample, whose
        step has just been taken."""
        state = self.state
        u = state.u - self.ahead * state.v
        v = (state.v + state.v_before) / 2
        return u[self.freedoms], v[self.freedoms], self.stress @ u + self.prestress

    def developed(self, result: Fields) -> Fields:
        """Return the run's result with its snapshots."""
        body, mesh = self.discrete.body, self.discrete.body.mesh
        u, v, stress = (np.stack(column) for column in zip(*self.shots, strict=True))
        cells = body.cells[:, self.parts].reshape(-1, self.parts.shape[1])
        height = body.y[cells].mean(axis=1)
        block = np.floor(height / self.discrete.properties.spacing).astype(int)
        time = result.coords["time"][1][:: self.every]
        found = snapshots(time[: len(u)], body.x, KINDS[mesh.cell], cells, block, u, v, stress)
        return with_snapshots(result, found)


def axial_stress(discrete: Discrete, parts: np.ndarray) -> csr_matrix:
    """Return the stress along the pillar (compression positive) at the centres of the linear cells
    of every cell, from the freedoms [cells * parts, freedoms]."""
    body = discrete.body
    nodes = compat.reference_element(body.mesh.cell, body.order).points
    centres = nodes[parts].mean(axis=1)
    cell = np.repeat(np.arange(len(body.cells)), len(parts))
    point = at_reference(body, cell, np.tile(centres, (len(body.cells), 1)))
    weights = -section_tractions(body, discrete.materials, point)[0]
    return matrix_of(body, np.arange(cell.size), cell, weights, cell.size)
