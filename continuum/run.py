"""A run of a scene before its first step."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from cases.schema.scene import Scene
from continuum.build import Discrete, build_model, critical_step_of, discretise
from continuum.model import Model
from continuum.parallel.serial import Serial
from continuum.scheme import Choice, choose
from continuum.size import refuse_large_run
from continuum.state import Samples, State, empty_samples, state_at_rest

if TYPE_CHECKING:
    from cases.incident import IncidentField
    from cases.schema.rock_mass import RockMass
    from continuum.plane.rock import PlaneDiscrete


class Run(NamedTuple):
    """A run of a scene: `rock` is "jointed" or "equivalent", model, state and samples are what it
    consists of, choice is how it is stepped; critical : the critical step of explicit steps, s."""

    scene: Scene | RockMass
    rock: str
    discrete: Discrete | PlaneDiscrete
    model: Model
    state: State
    samples: Samples
    choice: Choice
    critical: float

    @property
    def communicator(self) -> Serial:
        """The processes that share the run."""
        return self.discrete.body.communicator


def run_of(
    scene: Scene | RockMass,
    rock: str,
    dim: int | None,
    comm,
    incident: IncidentField | None = None,
) -> Run:
    """Return the run of a scene, at rest; comm : mpi4py's communicator of those who share it;
    incident : of the waves of a rock mass, None: in intact rock."""
    if scene.kind == "rock mass":
        from continuum.plane.run import run_of as of_rock_mass

        return of_rock_mass(scene, rock, comm, incident)
    discrete = discretise(scene, rock, dim, comm if comm is not None and comm.size > 1 else None)
    choice, critical = _choice(scene, discrete, rock)
    refuse_large_run(scene, discrete.kinematics, choice.time)
    model = build_model(scene, discrete, rock, choice.time)
    state = state_at_rest(model, scene.record.energy)
    samples = empty_samples(model, state, choice.time.samples)
    return Run(scene, rock, discrete, model, state, samples, choice, critical)


def steps_of(scene: Scene, rock: str, dim: int | None = None) -> tuple[Choice, float]:
    """Return how a scene is stepped, and the critical step of explicit steps (s)."""
    return _choice(scene, discretise(scene, rock, dim), rock)


def _choice(scene: Scene, discrete: Discrete, rock: str) -> tuple[Choice, float]:
    critical = critical_step_of(scene, discrete, rock)
    return choose(scene, discrete, critical), critical
