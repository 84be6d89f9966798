"""The pillar in Akantu, run by the Python of the peers' environment.

usage: python run_akantu.py FOLDER (reads pillar.json, pillar.msh and material.dat there, writes
stress.txt, compression positive, and seconds.json)
"""

import json
import sys
from pathlib import Path
from time import perf_counter

import akantu as aka
import numpy as np


def model_of(pillar: dict, mesh) -> "aka.SolidMechanicsModel":
    """Return the model with lumped mass and central differences, at rest.

    The loaded nodes have the acceleration by the load of step 0, for the first half velocity step.
    """
    model = aka.SolidMechanicsModel(mesh)
    model.initFull(_analysis_method=aka._explicit_lumped_mass)
    model.setTimeStep(pillar["dt"])
    loaded, share = pillar["loaded"], np.array(pillar["share"])
    model.assembleMassLumped()
    mass = model.getMass()[loaded, 0]
    model.getAcceleration()[loaded, 0] = pillar["load"][0] * share / mass
    return model


def march(pillar: dict, model, stress: np.ndarray) -> list[float]:
    """Take all steps and return the samples of -stress at the receiver, Pa."""
    loaded, share = pillar["loaded"], np.array(pillar["share"])
    load, stride = pillar["load"], pillar["stride"]
    points, force = np.array(pillar["points"]), model.getExternalForce()
    samples = [0.0]
    for step in range(1, pillar["steps"] + 1):
        if step < len(load):
            force[loaded, 0] = load[step] * share
        model.solveStep()
        if step % stride == 0:
            samples.append(-stress[points, 0].mean())
    return samples


def main(folder: Path) -> None:
    """Run one generated input."""
    pillar = json.loads((folder / "pillar.json").read_text())
    aka.parseInput(str(folder / "material.dat"))
    mesh = aka.Mesh(pillar["dimension"])
    mesh.read(str(folder / "pillar.msh"))
    model = model_of(pillar, mesh)
    stress = model.getMaterial(0).getStress(getattr(aka, pillar["element"]))
    began = perf_counter()
    samples = march(pillar, model, stress)
    spent = perf_counter() - began
    np.savetxt(folder / "stress.txt", samples, fmt="%.17g")
    (folder / "seconds.json").write_text(json.dumps({"stepping": spent}))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
