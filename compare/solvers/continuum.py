"""The continuum engine's two entries in the registry, one for each model of the rock."""

from __future__ import annotations

from contextlib import AbstractContextManager
from functools import partial
from typing import TYPE_CHECKING, Any

from jointwave.cases.run_memory import estimates
from jointwave.cases.scene_type import AnyScene
from jointwave.compare.solvers.incident import incident, note_sides
from jointwave.compare.solvers.record import Answer, Form, Kind, Line, Prepared, Rock, Solver

if TYPE_CHECKING:
    import xarray as xr


#: How to install the continuum's libraries.
INSTALL = 'pip install "jointwave[continuum]" (Linux, Python 3.12), or dolfinx by apt or conda'


def applies(scene: AnyScene, model: str) -> Answer:
    """Return whether dolfinx is installed and the model is valid for the scene."""
    try:
        from jointwave.continuum import applies as reason_against
    except ImportError as error:
        return Answer(f"FEniCSx cannot be imported ({error}); {INSTALL}")
    reason = reason_against(scene, model)
    return Answer(reason or "")


def run(scene: AnyScene, progress=None, comm=None, keeper=None, *, model: str) -> xr.Dataset:
    """Return the result of a scene; comm : mpi4py's, of the processes that share the run."""
    from jointwave.continuum import simulate

    about: dict[str, Any] = {"progress": progress, "comm": comm, "keeper": keeper}
    found = simulate(scene, model=model, **about, incident=incident(scene))
    note_sides(found.attrs, scene)
    return found


def prepare(scene: AnyScene, model: str) -> Prepared:
    """Return the time step and the size of a run. Raises SceneError like the run."""
    from jointwave.continuum.plan import plan_of

    with estimates() as parts:
        plan = plan_of(scene, model)
    incident(scene)  # raises SceneError if the field is unknown
    body, choice = plan.found.body, plan.choice
    settings = {
        "scheme": choice.scheme,
        "dim": body.components,
        "cell": body.cell.kind,
        "order": scene.numerics.continuum.order,
    }
    time, freedoms, size = choice.time, body.stiffness.shape[0], sum(parts.values())
    return Prepared(choice.scheme, time.steps, time.dt, plan.critical, freedoms, size, settings)


def bodies_kept() -> AbstractContextManager[None]:
    """Return a context in which runs share equal bodies."""
    from jointwave.continuum.scene import bodies_kept

    return bodies_kept()


def libraries() -> dict[str, str]:
    """Return the version of dolfinx."""
    from jointwave.continuum.space.fenicsx import dolfinx

    return {"dolfinx": dolfinx.__version__}


def _of(model: str, **about: Any) -> Solver:
    return Solver(
        name=f"continuum-{model}",
        form=Form.RUN,
        kinds=("pillar", "rock mass"),
        dimension=3,
        in_space=True,
        applies=partial(applies, model=model),
        run=partial(run, model=model),
        prepare=partial(prepare, model=model),
        engine="continuum",
        model=model,
        schemes=("explicit", "implicit"),
        cost=("scheme", "dim", "cell", "order", "processes"),
        shares=True,
        bodies_kept=bodies_kept,
        libraries=libraries,
        **about,
    )


JOINTED_ROCK = _of(
    "jointed",
    rock=Rock.JOINTED,
    label="jointed rock",
    sentence="Jointed rock, a continuum with every joint, is",
    line=Line("#f0a030", 3.4, 1),
    distances={
        Kind.BETWEEN: {
            "dem": "two engines, same joints",
            "continuum-equivalent": "one engine, with and without joints",
        }
    },
)
EQUIVALENT_ROCK = _of(
    "equivalent",
    rock=Rock.HOMOGENISED,
    label="homogenised rock",
    sentence="Homogenised rock, a continuum without joints, is",
    line=Line("#8fd4bd", 4.8, 0),
    distances={Kind.BETWEEN: {"dem": "two engines, with and without joints"}},
)
