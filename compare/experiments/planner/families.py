"""Families of configurations: an engine, its scheme and elements, at any number of steps."""

from math import ceil
from typing import Any, NamedTuple

from cases.errors import SceneError
from cases.kinds import checked
from cases.sampling import sample_times
from cases.schema.scene import Numerics, Scene
from compare.engines import ENGINES, applies, solver
from compare.solvers.continuum import EQUIVALENT_ROCK, JOINTED_ROCK
from compare.solvers.dem import DEM

COARSEST = 0.9  # of the critical step, explicit
#: Explicit steps that an implicit one costs, at least.
IMPLICIT = 500


class Family(NamedTuple):
    """Configurations that differ in their step alone.

    name : of the engine. changes : of its numerics. order : of the scheme.
    """

    name: str
    changes: dict[str, Any]
    order: int

    @property
    def engine(self) -> str:
        """The table of [numerics] that `changes` are of."""
        return ENGINES[self.name].engine

    @property
    def label(self) -> str:
        """Its name and what it changes, in a line."""
        return f"{self.name} ({', '.join(f'{k} {v}' for k, v in self.changes.items())})"

    @property
    def is_implicit(self) -> bool:
        """Whether its steps are not bounded by a critical one."""
        return self.changes["scheme"] == "implicit"


def _rock(name: str, order: int, elements: int) -> Family:
    changes = {"scheme": "explicit", "order": order, "elements_per_block": elements}
    return Family(name, changes, 2)


def _implicit(name: str, order: int) -> Family:
    """Without numerical damping: only the accuracy of the waveforms counts here."""
    found = _rock(name, order, 1)
    return found._replace(changes={**found.changes, "scheme": "implicit", "spectral_radius": 1.0})


_BOTH = JOINTED_ROCK.name, EQUIVALENT_ROCK.name
#: Coarse ones first: what they give tells whether finer ones need a trial.
FAMILIES = (
    Family(DEM.name, {"scheme": "leapfrog"}, 2),
    Family(DEM.name, {"scheme": "fourth-order"}, 4),
    *(_rock(name, p, 1) for p in (1, 2, 3, 4) for name in _BOTH),
    *(_rock(JOINTED_ROCK.name, p, n) for p, n in ((1, 2), (2, 2), (1, 4), (4, 2))),
    *(_implicit(name, p) for p in (1, 2, 4) for name in _BOTH),
)


def is_finer(one: Family, other: Family) -> bool:
    """Return whether a family has all the elements of another and more, so that it costs more."""
    keys = "order", "elements_per_block"
    alike = (one.name, one.changes["scheme"]) == (other.name, other.changes["scheme"])
    return (
        alike
        and one != other
        and all(one.changes.get(key, 0) >= other.changes.get(key, 0) for key in keys)
    )


class Effort(NamedTuple):
    """The cost of a family's coarsest step: steps per sample, and freedom-steps of the run."""

    least: int
    work: float


def effort(scene: Scene, family: Family) -> Effort:
    """Return what a family takes at its coarsest, before it is run; SceneError where it cannot."""
    answer = applies(family.name, scene)
    if not answer:
        raise SceneError(scene.where, "", None, answer.reason)
    run = solver(family.name).prepare(configured(scene, family, {}))
    freedoms, critical = run.freedoms, run.critical
    least = 1 if family.is_implicit else ceil(scene.interval / (COARSEST * critical) * (1 - 1e-9))
    each = IMPLICIT if family.is_implicit else family.order**2 / 4  # the fourth order: four forces
    return Effort(least, each * freedoms * least * len(sample_times(scene)))


def settings(scene: Scene, family: Family, per_sample: int, critical: float) -> dict[str, Any]:
    """Return the numerics that take so many steps per sample; critical : the critical step, s."""
    dt = scene.interval / per_sample
    if not family.is_implicit:
        return {"step_fraction": float(f"{dt / critical * (1 + 1e-6):.7g}")}
    from continuum.build import resolved_period

    return {"steps_per_period": float(f"{resolved_period(scene) / dt * (1 - 1e-6):.7g}")}


def plain(scene: Scene) -> Scene:
    """Return a scene with default numerics, without ledger and snapshots."""
    record = scene.record.model_copy(
        update={"interval": scene.interval, "energy": False, "fields": None}
    )
    return scene.model_copy(update={"numerics": Numerics(), "record": record, "expect": {}})


def configured(scene: Scene, family: Family, more: dict[str, Any]) -> Scene:
    """Return a scene with a family's numerics, its own where the family has none; raises SceneError
    where it cannot have them."""
    table = getattr(scene.numerics, family.engine).model_copy(update=family.changes | more)
    numerics = scene.numerics.model_copy(update={family.engine: table})
    return checked(plain(scene).model_copy(update={"numerics": numerics}))
