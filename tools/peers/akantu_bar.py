"""The pillar in Akantu: the homogenised rock mass as a bar, and as a column of hexahedra.

Richart et al., JOSS 9 (2024) 5253. Linear elements, lumped mass, central differences.
"""

import json
from pathlib import Path

import mesh
import numpy as np
from environment import Place
from job import Job, Twin, folder_of, read_driven
from mesh import Mesh
from ours import KINDS
from pillar import Pillar, pillar, stride_for

from jointwave.cases.schema.scene import Scene

#: By dimension: elements per block (in the column also across it); curve; jointwave model compared
#: with it; element name.
POINTS = {1: (1, 2, 4, 8), 3: (1, 2)}
CURVES = {1: "Akantu bar", 3: "Akantu hexahedra"}
TWINS = {1: "homogenised bar", 3: "homogenised column"}
ELEMENTS = {1: "_segment_2", 3: "_hexahedron_8"}
#: Step over the time of a wave through an element; in cubes other modes limit the step, too.
OF_CRITICAL = {1: 0.8, 3: 0.5}


def jobs(scene: Scene, place: Place, root: Path) -> list[Job]:
    """Write the inputs of the runs in both dimensions, and return the runs."""
    return [job(scene, dim, n, place, root) for dim, counts in POINTS.items() for n in counts]


def job(scene: Scene, dim: int, n: int, place: Place, root: Path) -> Job:
    """Write the input of one run with n elements per block, and return the run."""
    stride = stride_for(scene, scene.pillar.block / n, dim, OF_CRITICAL[dim])
    p, folder = pillar(scene, stride), folder_of(root, CURVES[dim], elements=n)
    built, alike = mesh_of(p, dim, n), KINDS[TWINS[dim]]
    mesh.write(folder / "pillar.msh", built)
    # A bar does not use Poisson's ratio.
    constants = f"  rho = {p.density!r}\n  E = {p.modulus!r}\n  nu = {p.poisson!r}\n"
    (folder / "material.dat").write_text(f"material elastic [\n  name = rock\n{constants}]\n")
    (folder / "pillar.json").write_text(json.dumps(numbers(p, built, dim, n)))
    return Job(
        curve=CURVES[dim],
        solves=alike.solves,
        reference=alike.reference,
        settings={"elements_per_block": n, "stride": stride},
        freedoms=dim * len(built.nodes),
        steps=p.steps,
        samples=p.samples,
        folder=folder,
        command=[*place.command, str(folder)],
        read=read_driven,
        twin=Twin(TWINS[dim], stride, n),
        environment=place.environment,
    )


def mesh_of(p: Pillar, dim: int, n: int) -> Mesh:
    """Return the pillar with n elements per block, in space n x n across."""
    length, count = p.blocks * p.spacing, n * p.blocks
    return mesh.bar(length, count) if dim == 1 else mesh.column(length, p.side, count, n)


def numbers(p: Pillar, built: Mesh, dim: int, n: int) -> dict:
    """Return the numbers that `run_akantu` reads.

    The receiver is at an interface of elements: its stress is the mean over the quadrature points
    of the layers on both sides, eight per hexahedron.
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
