"""The pillar in Yade: what `yade` itself runs on a generated chain of spheres.

usage: yade -n -x -j1 run_yade.py FOLDER (reads pillar.json there, writes stress.txt, compression
positive, and seconds.json)
"""

import json
import sys
from pathlib import Path
from time import perf_counter

from yade import (
    Bo1_Sphere_Aabb,
    CohFrictMat,
    ForceResetter,
    Ig2_Sphere_Sphere_ScGeom6D,
    InsertionSortCollider,
    InteractionLoop,
    InterpolatingDirectedForceEngine,
    Ip2_CohFrictMat_CohFrictMat_CohFrictPhys,
    Law2_ScGeom6D_CohFrictPhys_CohesionMoment,
    NewtonIntegrator,
    PyRunner,
    utils,
)
from yade.wrapper import Omega

UNBREAKABLE = 1e30  # Pa
REACH = 1.5  # of the radii within which spheres bond: neighbours, and none but they

omega = Omega()
folder = Path(sys.argv[-1])
pillar = json.loads((folder / "pillar.json").read_text())
samples: list[float] = []


def record():
    """Append the normal stress of the recorded contact, Pa; runs between forces and motion."""
    contact = omega.interactions[pillar["joint"] - 1, pillar["joint"]]
    samples.append(contact.phys.normalForce[1] / pillar["area"])


def fill():
    """Put the spheres in a row along y."""
    omega.materials.append(
        CohFrictMat(
            young=pillar["modulus"],
            poisson=pillar["shear_ratio"],
            density=pillar["density"],
            frictionAngle=0,
            isCohesive=True,
            normalCohesion=UNBREAKABLE,
            shearCohesion=UNBREAKABLE,
            momentRotationLaw=True,
            alphaKr=1,
            alphaKtw=1,
            etaRoll=-1,
            etaTwist=-1,
        )
    )
    r = pillar["radius"]
    for i in range(pillar["count"]):
        omega.bodies.append(utils.sphere((0, (2 * i + 1) * r, 0), r))


def engines():
    """Return what a step does."""
    times = [i * pillar["dt"] for i in range(len(pillar["load"]))]
    return [
        ForceResetter(),
        InsertionSortCollider([Bo1_Sphere_Aabb(aabbEnlargeFactor=REACH)]),
        InteractionLoop(
            [Ig2_Sphere_Sphere_ScGeom6D(interactionDetectionFactor=REACH)],
            [Ip2_CohFrictMat_CohFrictMat_CohFrictPhys(setCohesionNow=True)],
            [Law2_ScGeom6D_CohFrictPhys_CohesionMoment()],
        ),
        PyRunner(command="record()", iterPeriod=pillar["stride"], initRun=True),
        InterpolatingDirectedForceEngine(
            ids=[0], direction=(0, 1, 0), times=times, magnitudes=pillar["load"]
        ),
        NewtonIntegrator(damping=0),
    ]


fill()
omega.engines = engines()
omega.dt = pillar["dt"]
began = perf_counter()
omega.run(pillar["steps"] + 1, True)
spent = perf_counter() - began
(folder / "stress.txt").write_text("\n".join(map(repr, samples)))
(folder / "seconds.json").write_text(json.dumps({"stepping": spent}))
