"""Scenes that processes share, and what each of several processes finds: run by mpiexec."""

import pickle
import sys
from pathlib import Path
from typing import Any

import pytest

from jointwave.cases.errors import InterruptedRun, SceneError, StoppedError
from jointwave.cases.read import load_variant
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.cases.schema.scene import Scene
from jointwave.compare.scenes import find
from jointwave.continuum.run import simulate
from jointwave.continuum.space.fenicsx import PETSc, shared_by
from jointwave.continuum.stepping import product
from tests.conftest import Checkpointer
from tests.continuum.bodies import PUSH, rock_mass

SAMPLES = 41
WHOLE = product.CACHE
WEAK = {"friction_angle": 30.0, "cohesion": 1e4, "tensile_strength": 5e4, "fracture_energy": 1.0}
BASE = {
    "kind": "base", "side": "bottom", "direction": [0.6, 0.8], "quantity": "velocity",
    "shape": "sine", "amplitude": 0.01, "period": 1e-3,
}  # fmt: skip


def scene(*joints, dim=2, scheme="explicit", continuum=None, **tables) -> RockMass:
    """Return a rock mass on a fixed base between quiet sides, loaded from above."""
    middle = [3.0, 2.0, 2.5][:dim]
    record = {"points": [[2.0, 1.5, 1.0][:dim], middle], "joints": [middle], "fields": 5e-4}
    table: dict[str, Any] = {
        "time": {"duration": 1e-3},
        "record": record | {"interval": 1e-3 / (SAMPLES - 1)},
        "loads": [PUSH],
        "boundaries": {"bottom": "fixed", "left": "quiet", "right": "quiet"},
    }
    own = {"size": 1.0, "scheme": scheme, **(continuum or {})}
    return rock_mass(*joints, dim=dim, continuum=own, **table | tables)


def plane(**changes) -> RockMass:
    """Return a scene of a joint that slips, opens and breaks, and one with dashpots."""
    weak = {"dip": 30.0, "through": [3.0, 2.0], **WEAK}
    return scene(weak, {"dip": -60.0, "through": [2.0, 2.0], "damping_ratio": 0.02}, **changes)


def scenes() -> dict[str, AnyScene]:
    """Return the scenes: joints of all kinds; equal blocks that share one matrix, periodic, on a
    base that is shaken; damped rock with a wave; space; implicit steps from rest; a pillar."""
    square = [{"dip": dip, "spacing": 0.5} for dip in (0.0, 90.0)]
    around = {"left": "periodic", "right": "periodic", "bottom": "fixed"}
    wave = {"kind": "P", "direction": [0.6, 0.8], "shape": "sine", "amplitude": 1e6, "period": 1e-3}
    quiet = dict.fromkeys(("left", "right", "bottom", "top"), "quiet")
    space = {"dip": 50.0, "dip_direction": 40.0, "through": [3.0, 2.0, 2.5], **WEAK}
    return {
        "plane": plane(),
        "blocks": scene(*square, boundaries=around, loads=[BASE], continuum={"size": 0.25}),
        "damped": scene(
            {"dip": 30.0, "through": [3.0, 2.0]}, loads=[], waves=[wave], boundaries=quiet,
            damping={"rayleigh": {"ratios": [0.02, 0.02], "frequencies": [200.0, 2000.0]}},
        ),
        "space": scene(space, dim=3, continuum={"size": 1.5}),
        "implicit": plane(scheme="implicit", gravity={"acceleration": 9.81}),
        "pillar": pillar(),
    }  # fmt: skip


def pillar() -> Scene:
    """Return a bar of rock with a quality factor and joints that open, on a base that is shaken,
    before an end that absorbs."""
    changes = {
        "pillar.length": 3.0, "record.stress": [0.0, 0.5, 1.1, 3.0], "record.velocity": [0.6, 1.5],
        "record.energy": True, "time.duration": 2e-3, "load.period": 5e-4,
        "numerics.continuum.scheme": "explicit", "numerics.continuum.elements_per_block": 2,
        "numerics.continuum.dim": 1, "joints.tension": False, "joints.damping_ratio": 0.002,
        "rock.quality_factor": 20.0, "load.quantity": "velocity", "load.amplitude": 0.1,
        "ends.start": "fixed", "ends.end": "matched",
    }  # fmt: skip
    return load_variant(find("guo-li-2002/fig-03"), "", changes)


def main(path: Path) -> None:
    """Write what processes find: the results, that of a run which was interrupted, and what each
    says of a run that diverges and of a mesh that is too small."""
    from mpi4py import MPI

    comm = MPI.COMM_WORLD
    first = PETSc.SF().create(shared_by(comm))
    if comm.rank == 0:
        first.destroy()  # as Python deletes objects earlier in one process than in another
    results = {}
    for name, one in scenes().items():
        # Of one scene by three processes it reads half of a matrix, as that of large ones does.
        product.CACHE = 0 if comm.size == 3 and name == "plane" else WHOLE
        results[name] = simulate(one, comm=comm)
    product.CACHE = 0 if comm.size == 3 else WHOLE
    keeper = Checkpointer(SAMPLES // 2)
    with pytest.raises(InterruptedRun):
        simulate(plane(), comm=comm, keeper=keeper)
    resumed = simulate(plane(), comm=comm, keeper=keeper)
    unstable = plane(continuum={"step_fraction": 1.3, "allow_unstable": True})
    with pytest.raises(StoppedError) as stopped:
        simulate(unstable, comm=comm)
    told = comm.allgather((str(stopped.value), stopped.value.result.sizes["time"]))
    with pytest.raises(SceneError) as refused:
        simulate(scene(record={"points": [[2, 1]]}, continuum={"size": 6.0}), comm=comm)
    refusals = comm.allgather(str(refused.value))
    if comm.rank == 0:
        path.write_bytes(pickle.dumps((results, resumed, told, refusals)))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
