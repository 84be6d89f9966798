"""The rigid-block engine's entry in the registry."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jointwave.cases.run_memory import estimates
from jointwave.cases.scene_type import AnyScene
from jointwave.compare.solvers.incident import incident, note_sides
from jointwave.compare.solvers.record import Answer, Form, Line, Prepared, Rock, Solver

if TYPE_CHECKING:
    import xarray as xr


def run(scene: AnyScene, progress=None, comm=None, keeper=None) -> xr.Dataset:
    """Return the result of a scene; `comm` is unused, as one process runs it."""
    from jointwave.dem import simulate

    found = simulate(scene, progress, keeper, incident(scene))
    note_sides(found.attrs, scene)
    return found


def prepare(scene: AnyScene) -> Prepared:
    """Return the time step and the size of a run. Raises SceneError like the run."""
    from jointwave.dem import plan

    incident(scene)  # raises SceneError if the field is unknown
    with estimates() as parts:
        found = plan(scene)
    scheme = getattr(scene.numerics.dem, "scheme", "leapfrog")
    settings = {"scheme": scheme, "threads": found.threads}
    time, size = found.time, sum(parts.values())
    return Prepared(scheme, time.steps, time.dt, found.critical, found.freedoms, size, settings)


def applies(scene: AnyScene) -> Answer:
    """Return whether rigid blocks can represent a scene."""
    if scene.rock.quality_factor is not None:
        from jointwave.cases.schema.damping import NOT_OF_BLOCKS

        return Answer(f"rock.quality_factor {NOT_OF_BLOCKS}")
    if scene.is_column:
        return Answer()
    from jointwave.cases.material.rigid_blocks import against

    reason = against(scene)
    return Answer(f"numerics.dem.block {reason}") if reason else Answer()


DEM = Solver(
    name="dem",
    rock=Rock.RIGID_BLOCKS,
    form=Form.RUN,
    kinds=("pillar", "rock mass"),
    dimension=3,
    in_space=True,
    label="rigid blocks",
    sentence="Rigid blocks are",
    line=Line("#56b4e9", 2.2, 2),
    applies=applies,
    run=run,
    prepare=prepare,
    engine="dem",
    schemes=("leapfrog", "fourth-order"),
    per_block=True,
    cost=("scheme", "threads"),
)
