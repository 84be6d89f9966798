"""The pillar in Akantu: the homogenised rock mass as a bar, and as a column of hexahedra.

Richart et al., JOSS 9 (2024) 5253. Linear elements, lumped mass, central differences; `run_akantu`
is what runs on the input that is written here.
"""

from pathlib import Path

import mesh
import numpy as np
from environment import Place
from job import Job, Twin, folder_of, read_driven, write_json
from mesh import Mesh
from ours import COLUMN
from pillar import Pillar, pillar, stride_for

from jointwave.cases.schema.scene import Scene

#: Elements a block by dimension, in the column across it too.
POINTS = {1: (1, 2, 4, 8), 3: (1, 2)}
OF_CRITICAL = {1: 0.8, 3: 0.5}  # by dimension; of a cube the P wave is not all that bounds it

SOLVES = {
    1: "continuum: the homogenised bar, 1 freedom a node",
    3: "continuum: the homogenised column in space, 3 freedoms a node",
}
CURVES = {1: "Akantu bar", 3: "Akantu hexahedra"}
OWN = {1: "equivalent-bar", 3: COLUMN}
TWINS = {1: "homogenised bar", 3: "homogenised column"}
ELEMENTS = {1: "_segment_2", 3: "_hexahedron_8"}


def jobs(scene: Scene, place: Place, root: Path) -> list[Job]:
    """Return the runs in both dimensions, inputs written."""
    return [job(scene, dim, n, place, root) for dim, counts in POINTS.items() for n in counts]


def job(scene: Scene, dim: int, n: int, place: Place, root: Path) -> Job:
    """Write the input of one run, of n elements a block, and return it."""
    stride = stride_for(scene, scene.pillar.block / n, dim, OF_CRITICAL[dim])
    p, folder = pillar(scene, stride), folder_of(root, CURVES[dim], elements=n)
    built = mesh_of(p, dim, n)
    mesh.write(folder / "pillar.msh", built)
    (folder / "material.dat").write_text(material(p))
    write_json(folder / "pillar.json", numbers(p, built, dim, n))
    freedoms = dim * len(built.nodes)
    return Job(
        curve=CURVES[dim],
        method="linear elements, lumped mass, central differences",
        solves=SOLVES[dim],
        reference=OWN[dim],
        settings={"elements_per_block": n, "stride": stride},
        freedoms=freedoms,
        steps=p.steps,
        work=freedoms * p.steps,
        samples=p.samples,
        folder=folder,
        command=[*place.command, str(folder)],
        read=read_driven,
        twin=Twin(TWINS[dim], stride, n),
        environment=place.environment,
    )


def mesh_of(p: Pillar, dim: int, n: int) -> Mesh:
    """Return the pillar in n elements a block, in space n x n across."""
    length, count = p.blocks * p.spacing, n * p.blocks
    return mesh.bar(length, count) if dim == 1 else mesh.column(length, p.side, count, n)


def material(p: Pillar) -> str:
    """Return the material file; a bar has no use for Poisson's ratio."""
    return (
        "material elastic [\n  name = rock\n"
        f"  rho = {p.density!r}\n  E = {p.modulus!r}\n  nu = {p.poisson!r}\n]\n"
    )


def numbers(p: Pillar, built: Mesh, dim: int, n: int) -> dict:
    """Return what `run_akantu` reads.

    The stress at the receiver, where elements meet, is the mean of the two layers beside it, at
    the eight quadrature points of each hexahedron.
    """
    points = 1 if dim == 1 else 8
    layer = points * len(built.elements) // (p.blocks * n)
    first = (p.joint * n - 1) * layer
    return {
        "dimension": dim,
        "element": ELEMENTS[dim],
        "dt": p.dt,
        "stride": p.stride,
        "steps": p.steps,
        "load": p.verlet_load.tolist(),
        "loaded": built.loaded.tolist(),
        "share": built.share.tolist(),
        "points": np.arange(first, first + 2 * layer).tolist(),
    }
