"""The registry of solvers by name: the engines and the exact solutions."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import cache
from importlib import import_module
from typing import TYPE_CHECKING

from jointwave.cases.errors import SceneError, nearest
from jointwave.cases.run_memory import refuse_beyond_memory, waveform_bytes
from jointwave.cases.scene_type import AnyScene
from jointwave.compare.solvers.continuum import EQUIVALENT_ROCK, JOINTED_ROCK
from jointwave.compare.solvers.dem import DEM
from jointwave.compare.solvers.record import Answer, Solver

if TYPE_CHECKING:
    import xarray as xr

    from jointwave.numerics.time_loop import Checkpointer

#: The engines by name; their packages are imported when they run.
ENGINES: dict[str, Solver] = {one.name: one for one in (DEM, JOINTED_ROCK, EQUIVALENT_ROCK)}

#: The modules of the exact solutions by name; each module ends with their records and is imported
#: on demand. The model that an engine discretises comes before coarser models.
EXACT = {
    "lattice": "blocks.row_of_blocks",
    "no-tension-chain": "blocks.row_of_blocks",
    "jointed-bar": "bar.bars",
    "equivalent-bar": "bar.bars",
    "images": "bar.images",
    "series": "bar.modes",
    "kelvin-voigt": "bar.modes",
    "one-joint": "joint.one_joint",
    "closing-joint": "joint.closing_joint",
    "spatial-lattice": "blocks.row_of_blocks",
    "slip-joint": "joint.sliding_joint",
    "sliding-block": "blocks.sliding_block",
    "normal-incidence": "rock_mass.normal_incidence",
    "oblique-joint": "rock_mass.stack_waves",
    "parallel-joints": "rock_mass.stack_waves",
    "line-force": "rock_mass.point_force",
    "point-force": "rock_mass.point_force",
    "effective-medium": "rock_mass.effective_medium",
    "block-lattice": "rock_mass.block_lattice",
}

Progress = Callable[[float], None]


def names(kind: str | None = None) -> tuple[str, ...]:
    """Return the names of all solvers; kind : only those for this kind of scene. Solutions of rock
    masses have their own folder, so that a pillar does not import them."""
    masses = kind == "rock mass"
    exact = (n for n, at in EXACT.items() if not kind or at.startswith("rock_mass.") == masses)
    return (*ENGINES, *exact)


@cache
def solver(name: str) -> Solver:
    """Return the record of an engine or exact solution; raises SceneError for an unknown name."""
    if name in ENGINES:
        return ENGINES[name]
    if name not in EXACT:
        allowed = f"{name!r} is unknown; allowed: {', '.join(names())}{nearest(name, names())}"
        raise SceneError("engine", "", None, allowed)
    records = vars(import_module(f".exact.{EXACT[name]}", __package__)).values()
    return next(one for one in records if isinstance(one, Solver) and one.name == name)


def label_of(name: str) -> str:
    """Return the label of a solver, such as "rigid blocks, exact"; other names unchanged."""
    return solver(name).label if name in names() else name


def in_words(text: object) -> str:
    """Return text with names of solutions replaced by labels: a name, a pair "one ~ other (%)", or
    the name after ": see "; other text unchanged."""
    reason, see, name = str(text).rpartition(": see ")
    pair, unit, rest = name.partition(" (%)")
    return reason + see + " ~ ".join(map(label_of, pair.split(" ~ "))) + unit + rest


def solvers() -> list[Solver]:
    """Return all records, engines first."""
    return [solver(name) for name in names()]


def in_order(found: Iterable[str]) -> list[str]:
    """Return names in the order of the registry, unknown ones last."""
    wanted = set(found)
    return [name for name in names() if name in wanted] + sorted(wanted - set(names()))


def selection() -> dict[str, dict[str | None, str]]:
    """Return the names of all solvers by values of --engine and --model."""
    found: dict[str, dict[str | None, str]] = {}
    for one in ENGINES.values():
        found.setdefault(one.engine, {})[one.model] = one.name
    return {**found, Solver.engine: {name: name for name in EXACT}}


def applies(name: str, scene: AnyScene) -> Answer:
    """Return whether a solver applies to a scene, with the reason if not."""
    one = solver(name)
    if scene.kind not in one.kinds:
        return Answer(f"is for a {one.kinds[0]}, not for a {scene.kind}")
    if scene.in_space and not one.in_space:
        return Answer("is for a rock mass in the plane, not for one in space")
    return one.applies(scene)


def solve(
    name: str,
    scene: AnyScene,
    progress: Progress | None = None,
    comm=None,
    keeper: Checkpointer | None = None,
) -> xr.Dataset:
    """Return the result of one engine or exact solution.

    comm : mpi4py's communicator of processes that share a run of the continuum, or None. keeper :
    saves checkpoints of an engine's run, or None. Raises SceneError if the solver is unknown or
    does not apply, UnstableError if a run becomes unstable.
    """
    one = solver(name)
    answer = applies(name, scene)
    if not answer:
        raise SceneError(scene.title, "", None, f"{name} does not apply: {answer.reason}")
    if name in ENGINES:
        return one.run(scene, progress, comm, keeper)
    try:
        refuse_beyond_memory(scene, {"record.interval": waveform_bytes(scene)})
        return one.run(scene)
    except MemoryError as error:
        raise SceneError(scene.where, "", None, f"not enough memory: {name}: {error}") from None
