"""A run of a scene before its first step."""

from __future__ import annotations

from typing import Any, NamedTuple

from jointwave.cases.incident import IncidentField
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.cases.schema.scene import Scene
from jointwave.continuum.build import build_model, critical_step_of, discretise
from jointwave.continuum.model import Model
from jointwave.continuum.parallel.serial import Serial
from jointwave.continuum.plane import run as rock_mass
from jointwave.continuum.scheme import Choice, choose
from jointwave.continuum.size import refuse_large_run
from jointwave.continuum.state import Samples, State, empty_samples, state_at_rest


class Run(NamedTuple):
    """A run of a pillar or a rock mass.

    scene, rock : of it, "jointed" or "equivalent". discrete : the scene in space, `continuum.build`
    or `continuum.plane.rock`. model, state, samples : what the run consists of. choice : how it is
    stepped. critical : the critical step of explicit steps, s. sudden : what begins to act at
    t = 0, the weight and what bears it, N [freedoms]; None without.
    """

    scene: Any
    rock: str
    discrete: Any
    model: Model
    state: State
    samples: Samples
    choice: Choice
    critical: float
    sudden: Any = None

    @property
    def communicator(self) -> Serial:
        """The processes that share the run."""
        return self.discrete.body.communicator


def run_of(
    scene: Scene | RockMass,
    rock: str,
    dim: int | None = None,
    comm=None,
    incident: IncidentField | None = None,
) -> Run:
    """Return the run of a scene, at rest; comm : mpi4py's communicator of those who share it;
    incident : of the waves of a rock mass, None: in intact rock."""
    discrete, choice, critical = discrete_and_steps(scene, rock, dim, comm)
    if isinstance(scene, Scene):
        model = build_model(scene, discrete, rock, choice.time)
    else:
        model = rock_mass.build_model(scene, discrete, choice.time, incident)
    state = state_at_rest(model, scene.record.energy)
    samples = empty_samples(model, state, choice.time.samples)
    return Run(scene, rock, discrete, model, state, samples, choice, critical)


def discrete_and_steps(
    scene: Scene | RockMass, rock: str, dim: int | None = None, comm=None
) -> tuple[Any, Choice, float]:
    """Return a scene in space, how it is stepped, and the critical step of explicit steps (s).

    Raises SceneError for a run that cannot be or would not fit in memory.
    """
    comm = comm if comm is not None and comm.size > 1 else None
    if not isinstance(scene, Scene):
        return rock_mass.discrete_and_steps(scene, rock, comm)
    discrete = discretise(scene, rock, dim, comm)
    critical = critical_step_of(scene, discrete, rock)
    choice = choose(scene, discrete, critical)
    refuse_large_run(scene, discrete.kinematics, choice.time)
    return discrete, choice, critical
