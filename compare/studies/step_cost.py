"""The cost of a time step per rigid block, or per degree of freedom of deformable rock."""

from collections.abc import Sequence
from pathlib import Path
from statistics import median
from typing import NamedTuple

from jointwave import cases
from jointwave.cases.scene_type import AnyScene
from jointwave.compare.engines import ENGINES, solve, solver
from jointwave.compare.runs import timings
from jointwave.compare.solvers.dem import DEM
from jointwave.results.dataset import scene_hash

SCENES = Path(__file__).parent / "scenes"
UNIT_STEPS = 1_000_000  # steps times blocks or freedoms of a timed run, about
REPEATS = 5
BLOCKS = 1000  # at most, in the scene with every effect
#: The scene of each kind with every effect, the key of its size, and this for a number of blocks.
EVERY_EFFECT = {
    "pillar": ("every-effect.toml", "pillar.length", lambda count: 0.5 * count),
    "rock mass": (
        "every-effect-in-plane.toml",
        "domain.size",
        lambda count: 2 * [float(max(2, int(count**0.5)))],
    ),
}


class StepCost(NamedTuple):
    """The least cost of a step among repeated runs, ns, and by how much their median exceeds it,
    the resolution of timings on this machine."""

    ns: float
    noise: float


def step_costs(scenes: Sequence[AnyScene], name: str = DEM.name) -> list[StepCost]:
    """Return the cost of a step per block or freedom for each scene in an engine.

    The beginning of each scene is run several times; the scenes alternate, so that temporary load
    of the machine affects all of them. The rates are saved, see `compare.runs.timings`.
    Raises SceneError if the engine does not apply, UnstableError if a run becomes unstable.
    """
    found: list[list[float]] = [[] for _ in scenes]
    with solver(name).bodies_kept():
        short = [shortened(scene, name, threads=1) for scene in scenes]
        for scene in short:
            solve(name, scene)  # compiles
        for _ in range(REPEATS):
            for scene, costs in zip(short, found, strict=True):
                about = solve(name, scene).attrs
                timings.note(name, scene, about)
                steps = about["steps"] * ENGINES[name].units(scene, about["degrees_of_freedom"])
                costs.append(1e9 * float(about["seconds_stepping"]) / steps)
    return [StepCost(min(ns), median(ns) - min(ns)) for ns in found]


def shortened(
    scene: AnyScene, name: str = DEM.name, unit_steps: int = UNIT_STEPS, threads: int | None = None
) -> AnyScene:
    """Return the beginning of a scene, at least one sample, without snapshots; an eighth without
    time steps. unit_steps : steps times blocks or freedoms, about. threads : None: as in the
    scene."""
    run = solver(name).prepare(scene)
    steps = run.steps * solver(name).units(scene, run.freedoms)
    part = min(1.0, unit_steps / steps) if steps else 1 / 8
    duration = scene.time.duration * part
    time = scene.time.model_copy(update={"duration": max(scene.interval, duration)})
    record = scene.record.model_copy(update={"interval": scene.interval, "fields": None})
    dem = scene.numerics.dem.model_copy(update={"threads": threads or scene.numerics.dem.threads})
    numerics = scene.numerics.model_copy(update={"dem": dem})
    return scene.model_copy(update={"time": time, "record": record, "numerics": numerics})


def with_every_effect(scene: AnyScene) -> AnyScene:
    """Return a scene of the same kind with every effect and about as many rigid blocks, since the
    fixed cost of a step matters if there are few."""
    dem, (file, key, size) = solver(DEM.name), EVERY_EFFECT[scene.kind]
    blocks = dem.units(scene, dem.prepare(scene).freedoms)
    return cases.load_variant(SCENES / file, "", {key: size(min(blocks, BLOCKS))})


def cost_of_every_effect(scene: AnyScene) -> StepCost:
    """Return the cost of a step per block with every effect that exists, for about as many blocks
    as a scene has; measured once per process."""
    full = with_every_effect(scene)
    name = scene_hash(full)
    if name not in _every_effect:
        (_every_effect[name],) = step_costs([full])
    return _every_effect[name]


_every_effect: dict[str, StepCost] = {}
