"""Families of configurations: an engine, its scheme and elements, for any number of steps."""

from __future__ import annotations

from math import ceil, inf
from typing import Any, NamedTuple

from cases.errors import SceneError
from cases.kinds import AnyScene, checked
from cases.sampling import sample_times
from cases.schema.pulse import shortest_period
from cases.schema.scene import Scene
from compare.engines import ENGINES, applies, solver
from compare.solvers.continuum import EQUIVALENT_ROCK, JOINTED_ROCK
from compare.solvers.dem import DEM

COARSEST = 0.9  # of the critical step, explicit
#: Explicit steps that an implicit one costs, at least.
IMPLICIT = 500
#: In a rock mass, in the length of its slowest waves: rigid blocks, and the fewest elements by
#: their order.
BLOCKS_IN_WAVE, ELEMENTS_IN_WAVE = (6, 12, 24, 48), {1: 20, 2: 6, 3: 3, 4: 2}


class Family(NamedTuple):
    """Configurations that differ only in their step.

    name : of the engine. changes : of its numerics. order : of the scheme.
    """

    name: str
    changes: dict[str, Any]
    order: int = 2

    @property
    def engine(self) -> str:
        """The table of [numerics] that `changes` belong to."""
        return ENGINES[self.name].engine

    @property
    def label(self) -> str:
        """Its name and changes, in one line."""
        changes = ", ".join(f"{k} {v}" for k, v in self.changes.items())
        return f"{self.name} ({changes})" if changes else self.name

    @property
    def is_implicit(self) -> bool:
        """Whether its steps are not bounded by a critical one."""
        return self.changes.get("scheme") == "implicit"

    @property
    def model(self) -> Family:
        """The model in the limit of fine steps and elements: the engine's, with these blocks."""
        return Family(self.name, {k: v for k, v in self.changes.items() if k == "block"})

    @property
    def fineness(self) -> tuple[float, ...]:
        """The order and the number of its elements, and the inverse of their size, or blocks'."""
        many = (self.changes.get(key, 0) for key in ("order", "elements_per_block"))
        return *many, *(1 / self.changes.get(key, inf) for key in ("size", "block"))


def families_of(scene: AnyScene) -> list[Family]:
    """Return the families of a scene, coarse ones first: their results show whether finer ones need
    a trial."""
    both, rigid = (JOINTED_ROCK.name, EQUIVALENT_ROCK.name), _rigid(scene)
    # Without numerical damping: only the accuracy of the waveforms counts here.
    implicit = {"scheme": "implicit", "spectral_radius": 1.0}
    quick = [rock(scene, name, p) for p in (1, 2, 4) for name in both]
    return [
        *rigid[:2],
        *(rock(scene, name, p) for p in (1, 2, 3, 4) for name in both),
        *(rock(scene, JOINTED_ROCK.name, p, n) for p, n in ((1, 2), (2, 2), (1, 4), (4, 2))),
        *rigid[2:],
        *(one._replace(changes=one.changes | implicit) for one in quick),
    ]


def _rigid(scene: AnyScene) -> list[Family]:
    """Return the schemes of a pillar's rigid blocks, or the sizes of a rock mass's."""
    if isinstance(scene, Scene):
        schemes = {"leapfrog": 2, "fourth-order": 4}
        return [Family(DEM.name, {"scheme": name}, order) for name, order in schemes.items()]
    own, length = scene.numerics.dem.block, _wave_length(scene)
    sizes = {own or inf, *(float(f"{length / n:.3g}") for n in BLOCKS_IN_WAVE)}
    return [Family(DEM.name, {} if x == inf else {"block": x}) for x in sorted(sizes)[::-1]]


def rock(scene: AnyScene, name: str, order: int, times: int = 1) -> Family:
    """Return deformable rock under explicit steps, its elements so many times as many in each
    direction as the fewest."""
    changes: dict[str, Any] = {"scheme": "explicit", "order": order}
    if isinstance(scene, Scene):
        return Family(name, changes | {"elements_per_block": times})
    size = _wave_length(scene) / (ELEMENTS_IN_WAVE[order] * times)
    return Family(name, changes | {"size": float(f"{size:.3g}")})


def _wave_length(scene: AnyScene) -> float:
    """Return the length (m) of the slowest waves of a rock mass, of the shortest period."""
    from cases.material.effective_medium import slowest

    return slowest(scene) * _period(scene)  # type: ignore[arg-type]


def _period(scene: AnyScene) -> float:
    return shortest_period(scene.pulses) or scene.time.duration / 10


def is_finer(one: Family, other: Family) -> bool:
    """Return whether a family refines the elements of another, so that it costs more."""
    schemes = (one.name, one.changes.get("scheme")), (other.name, other.changes.get("scheme"))
    pairs = zip(one.fineness, other.fineness, strict=True)
    return schemes[0] == schemes[1] and one != other and all(a >= b for a, b in pairs)


class Effort(NamedTuple):
    """The cost of a family's coarsest step: steps per sample, and freedom-steps of the run."""

    least: int
    freedoms: int
    work: float


def effort(scene: AnyScene, family: Family) -> Effort:
    """Return a family's cost at its coarsest, before a run; raises SceneError if it cannot run."""
    asked = configured(scene, family, {})
    answer = applies(family.name, asked)
    if not answer:
        raise SceneError(scene.where, "", None, answer.reason)
    run = solver(family.name).prepare(asked)
    freedoms, critical = run.freedoms, run.critical
    least = 1 if family.is_implicit else ceil(scene.interval / (COARSEST * critical) * (1 - 1e-9))
    each = IMPLICIT if family.is_implicit else family.order**2 / 4  # the fourth order: four forces
    return Effort(least, freedoms, each * freedoms * least * len(sample_times(scene)))


def settings(scene: AnyScene, family: Family, per_sample: int, critical: float) -> dict[str, Any]:
    """Return the numerics with `per_sample` steps per sample; critical : the critical step, s."""
    dt = scene.interval / per_sample
    if not family.is_implicit:
        return {"step_fraction": float(f"{dt / critical * (1 + 1e-6):.7g}")}
    return {"steps_per_period": float(f"{_period(scene) / dt * (1 - 1e-6):.7g}")}


def plain(scene: AnyScene) -> AnyScene:
    """Return a scene with default numerics, without ledger and snapshots."""
    record = scene.record.model_copy(
        update={"interval": scene.interval, "energy": False, "fields": None}
    )
    numerics = type(scene.numerics)()
    return scene.model_copy(update={"numerics": numerics, "record": record, "expect": {}})


def configured(scene: AnyScene, family: Family, more: dict[str, Any]) -> AnyScene:
    """Return a scene with a family's numerics, otherwise its own; raises SceneError if it cannot
    have them."""
    table = getattr(scene.numerics, family.engine).model_copy(update=family.changes | more)
    numerics = scene.numerics.model_copy(update={family.engine: table})
    return checked(plain(scene).model_copy(update={"numerics": numerics}))
