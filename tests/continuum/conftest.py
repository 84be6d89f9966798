"""What the tests of the continuum share: short pillars, their bodies, and runs step by step."""

from typing import Any, NamedTuple

import meshio
import numpy as np
import pytest

from jointwave.cases.gmsh_file import FACET_NAMES, FROM_GMSH, KINDS
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.sampling import Clock
from jointwave.cases.schema.scene import Scene
from jointwave.continuum.build import Discrete, build_model, critical_step_of, discretise
from jointwave.continuum.explicit import leapfrog, march
from jointwave.continuum.explicit.march import march as march_of
from jointwave.continuum.mesh.cells import DIMENSION
from jointwave.continuum.mesh.pillar import pillar_mesh
from jointwave.continuum.space.body import build_body
from jointwave.continuum.space.elasticity import Material, Section
from jointwave.continuum.state import empty_samples, state_at_rest
from jointwave.continuum.waveforms import waveforms
from jointwave.numerics.divergence import guard

ROCK = Material(modulus=8.64e10, poisson=0.25, density=2400.0)

SHORT: dict[str, Any] = {
    "pillar__length": 2.0,
    "load__amplitude": 1e5,
    "time__duration": 4e-3,
    "record": {"stress": [0.2, 1.0, 1.6], "velocity": [0.0, 0.3, 1.0], "interval": 5e-5},
    "numerics__continuum__elements_per_block": 1,
}


def take(model, state, samples, stride, first, last):
    """Take the steps first .. last - 1 within bounds that only a NaN exceeds: by the kernel of a
    simulation, which other tests compile too."""
    limits = guard(np.inf)
    limits.peak[0] = np.inf
    march_of(model, state, samples, stride, limits)(first, last)


class Run(NamedTuple):
    """A scene in the middle of its steps."""

    scene: Scene
    discrete: Discrete
    model: Any
    state: Any
    samples: Any
    time: Clock

    def take(self, first: int, last: int) -> "Run":
        """Take the steps first .. last - 1."""
        take(self.model, self.state, self.samples, self.time.stride, first, last)
        return self

    def to_the_end(self) -> "Run":
        """Take all steps, up to the last sample."""
        return self.take(0, self.time.steps + 1)

    @property
    def waves(self) -> dict[str, np.ndarray]:
        """What has been recorded, as `results.dataset` takes it."""
        return waveforms(self.scene, self.discrete, self.samples)


@pytest.fixture
def short(pillar):
    """Return a function that gives four blocks of 0.5 m, one element long, keys changed."""

    def scene(**changes):
        record = SHORT["record"] | changes.pop("record", {})
        keys = SHORT | {"record": record} | changes
        if "numerics__continuum__mesh" in changes:
            del keys["numerics__continuum__elements_per_block"]
        return pillar(**keys)

    return scene


@pytest.fixture
def ready():
    """Return a function that gives the `Run` of a scene before its first step.

    fraction : of the critical step; samples : how many, one at every step. Or a whole clock.
    """

    def prepared(scene, model="jointed", dim=None, fraction=0.5, samples=81, clock=None):
        discrete = discretise(scene, model, dim)
        if clock is None:
            clock = Clock(fraction * critical_step_of(scene, discrete, model), 1, samples)
        built = build_model(scene, discrete, model, clock)
        state = state_at_rest(built, scene.record.energy)
        return Run(scene, discrete, built, state, empty_samples(built, state, clock.samples), clock)

    return prepared


@pytest.fixture
def body(pillar):
    """Return a function that gives the discretised rock of a pillar that all its joints cut.

    Blocks are 0.5 m long, the section is 0.5 m x 0.5 m. bent : function of the vertices [n, dim]
    that moves them.
    """

    def build(dim, cell="hexahedron", order=2, blocks=3, along=1, across=2, rock=ROCK, bent=None):
        p = calibrate(pillar(pillar__length=0.5 * blocks, record={"stress": [0.5]}))
        mesh = pillar_mesh(p, dim, cell, along, across, np.arange(blocks - 1))
        if bent is not None:
            mesh = moved(mesh, bent)
        extent = {1: p.area, 2: p.side, 3: 1.0}[dim]
        return build_body(mesh, order, [rock], Section(dim, extent))

    return build


@pytest.fixture
def rebuilt():
    """Return a function that discretises another mesh as a body is discretised."""
    return lambda body, mesh, rock=ROCK: build_body(mesh, body.order, [rock], body.section)


def moved(mesh, bent):
    """Return a mesh whose vertices a function has moved: as parts that stand once."""
    parts = []
    for part in mesh.parts:
        for shift in part.shifts:
            once = np.zeros((1, len(shift)))
            parts.append(part._replace(x=bent(part.x + shift), shifts=once))
    joints = mesh.joints._replace(corners=bent(mesh.joints.corners))
    sides = {k: side._replace(corners=bent(side.corners)) for k, side in mesh.sides.items()}
    return mesh._replace(parts=tuple(parts), joints=joints, sides=sides)


@pytest.fixture
def exported(tmp_path):
    """Return a function that saves a mesh without layers as a gmsh file, all its copies."""

    def save(mesh):
        x, cells, first = [], [], 0
        for part in mesh.parts:
            x.append((part.shifts[:, None] + part.x).reshape(-1, part.x.shape[1]))
            copy = first + len(part.x) * np.arange(part.copies)[:, None, None]
            cells.append((copy + part.cells).reshape(-1, part.cells.shape[1]))
            first += len(x[-1])
        x, cells = np.concatenate(x), np.concatenate(cells)
        name = next(name for name, kind in KINDS.items() if kind == mesh.cell)
        groups = {"rock": (name, cells[:, np.argsort(FROM_GMSH[mesh.cell])])}
        joints, facet = mesh.joints, FACET_NAMES[mesh.cell]
        for joint in np.unique(joints.joint):
            here = joints.joint == joint
            sides = [(side[here], joints.corners[here]) for side in (joints.left, joints.right)]
            found = [vertices(x, cells, *side) for side in sides]
            groups[f"joint {joint}"] = facet, np.concatenate(found)
        for end in ("start", "end"):
            groups[end] = facet, vertices(x, cells, *getattr(mesh, end))
        tags = [np.full(len(found), 1 + k) for k, (_, found) in enumerate(groups.values())]
        dims = [DIMENSION[mesh.cell] - (name != "rock") for name in groups]
        file = meshio.Mesh(
            np.pad(x, ((0, 0), (0, 3 - x.shape[1]))),
            list(groups.values()),
            cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags},
            field_data={n: np.array([1 + k, dims[k]]) for k, n in enumerate(groups)},
        )
        meshio.write(tmp_path / "pillar.msh", file, "gmsh22")
        return tmp_path / "pillar.msh"

    return save


def vertices(x, cells, cell, corners):
    """Return which vertices of these cells are at the corners of facets [facets, corners]."""
    apart = np.linalg.norm(x[cells[cell]][:, None] - corners[:, :, None], axis=-1)
    return np.take_along_axis(cells[cell], apart.argmin(axis=2), axis=1)


def multiply(tiles, pairs, start, column, value, x, y, factor):
    """Set y = factor K x, tile by tile: as the compiled one does."""
    for at, width, first, size in tiles.tolist():
        blocks = x[at : at + size * width].reshape(size, width)
        for i in range(size):
            own = slice(int(start[first + i]), int(start[first + i + 1]))
            y[at + i * width : at + (i + 1) * width] = factor * value[own] @ blocks[column[own]]


def rows(first, start):
    """Yield each row of stencils, how far it is from its first, and its entries."""
    first, start = first.astype(int).tolist(), start.astype(int).tolist()
    for r, begin in enumerate(first[:-1]):
        for i in range(first[r + 1] - begin):
            yield begin + i, i, slice(start[r], start[r + 1])


def multiply_stencils(first, start, column, value, x, y, begin):
    """Set y = B x in the rows of stencils `begin` and after."""
    for row, i, own in rows(first[int(begin) :], start[int(begin) :]):
        y[row] = value[own] @ x[column[own].astype(int) + i]


def add_transposed(first, start, column, value, t, f):
    """Add B^T t to f."""
    for row, i, own in rows(first, start):
        np.add.at(f, column[own].astype(int) + i, value[own] * t[row])


@pytest.fixture
def plain(monkeypatch):
    """Let explicit steps run as plain Python: nothing is compiled."""
    kernel_for = march.leapfrog_for

    def python_for(*effects, **shared):
        kernel = kernel_for(*effects, **shared)
        return getattr(kernel, "__wrapped__", kernel)

    monkeypatch.setattr(march, "leapfrog_for", python_for)
    for function in (multiply, multiply_stencils, add_transposed):
        monkeypatch.setattr(leapfrog, function.__name__, function)
    monkeypatch.setattr(leapfrog, "flush_denormals", lambda: 0)
    monkeypatch.setattr(leapfrog, "restore_denormals", lambda old: None)
