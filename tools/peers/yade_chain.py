"""The pillar in Yade: a chain of cohesive spheres that touch, six freedoms each.

Smilauer et al., Yade Documentation, 3rd ed. (2021). `run_yade` is what runs on the input that is
written here. Leapfrog begins with a whole kick, as ours does.
"""

from pathlib import Path

import numpy as np
from environment import Place
from job import Job, Twin, folder_of, read_driven, write_json
from pillar import Pillar, pillar

from cases.schema.scene import Scene

STRIDES = (1, 2, 4, 16)

CURVE = "Yade spheres"
SOLVES = "cohesive spheres in contact, 6 freedoms each"


def jobs(scene: Scene, place: Place, root: Path) -> list[Job]:
    """Return the runs, inputs written."""
    return [job(pillar(scene, stride), place, root) for stride in STRIDES]


def job(p: Pillar, place: Place, root: Path) -> Job:
    """Write the input of one run and return it."""
    folder = folder_of(root, CURVE, stride=p.stride)
    write_json(folder / "pillar.json", numbers(p))
    return Job(
        curve=CURVE,
        method="leapfrog",
        solves=SOLVES,
        reference="lattice",
        settings={"stride": p.stride},
        freedoms=6 * p.blocks,
        steps=p.steps,
        work=p.blocks * p.steps,
        samples=p.samples,
        folder=folder,
        command=[*place.command, str(folder)],
        read=read_driven,
        twin=Twin("blocks in space", p.stride),
        environment=place.environment,
    )


def numbers(p: Pillar) -> dict:
    """Return what `run_yade` reads.

    Between equal spheres of modulus E and radius r Yade's contact has k_n = E r, k_s = poisson k_n.
    """
    radius = p.spacing / 2
    return {
        "count": p.blocks,
        "radius": radius,
        "density": p.mass / (4 / 3 * np.pi * radius**3),
        "modulus": p.normal / radius,
        "shear_ratio": p.shear / p.normal,
        "joint": p.joint,
        "area": p.area,
        "dt": p.dt,
        "stride": p.stride,
        "steps": p.steps,
        "load": (p.load * p.area).tolist(),
    }
