"""The ablation of many scenes: solved and compiled on any executor, then timed one at a time."""

from pathlib import Path
from typing import NamedTuple

import cases
from cases.kinds import AnyScene, pillar_of
from cases.schema.scene import Scene
from compare.engines import Progress
from compare.experiments.ablation.ablation import Ablation, Dropped, ablate, prepare
from compare.scenes import find, shipped
from compare.studies import store
from compare.studies.store import Pool, Store, alone
from results.dataset import scene_hash

PREPARING = 0.8  # of the time, if nothing is compiled yet

#: Scenes of the report's page, each with its variants, whose kernels are compiled there anyhow.
REPORTED = {
    "guo-li-2002/fig-03": ["zeta 0.05"],
    "guo-li-2002/fig-05": ["matched"],
    "guo-li-2002/fig-07": ["soft layer"],
    "guo-li-2002/fig-09": ["no tension"],
    "beyond/paper-effects": [""],
}


class Variant(NamedTuple):
    """One variant of a scene, and the scene's name as its user knows it."""

    name: str
    scene: AnyScene

    @property
    def key(self) -> str:
        """The key of the case: a hash of everything that determines the result."""
        return store.key(self.name, self.scene.name, scene_hash(self.scene))


def all_shipped() -> list[Variant]:
    """Return every variant of every shipped pillar."""
    return [
        Variant(f"{path.parent.name}/{path.stem}", scene)
        for path in shipped()
        for scene in cases.load(path)
        if isinstance(scene, Scene)
    ]


def reported() -> list[Variant]:
    """Return the cases of the report's page."""
    return [
        Variant(name, pillar_of(cases.load_variant(find(name), variant)))
        for name, variants in REPORTED.items()
        for variant in variants
    ]


def run(
    wanted: list[Variant], folder: Path, pool: Pool | None = None, progress: Progress | None = None
) -> list[Ablation]:
    """Return the ablation of all cases, in order; completed ones are read from `folder`.

    pool : makes the executor that solves and compiles; timing is done in this process, one by one.
    """
    done = ablations(folder)
    tell = progress or (lambda fraction: None)
    new = [case for case in wanted if not done.has(case.key)]
    results = prepared(new, folder, pool, lambda x: tell(PREPARING * x))
    dropped = {case.key: one for case, one in zip(new, results, strict=True)}
    with alone():
        return done.compute(
            wanted,
            lambda case: case.key,
            lambda case: ablate(case.name, case.scene, dropped[case.key]),
            progress=lambda part: tell(PREPARING + (1 - PREPARING) * part),
        )


def prepared(
    wanted: list[Variant], folder: Path, pool: Pool | None = None, progress: Progress | None = None
) -> list[list[Dropped]]:
    """Return the results without each effect of all cases, which are saved in `folder`, and
    compile what `run` will time."""
    known = Store[list[Dropped]](list[Dropped], folder)
    return known.compute(wanted, lambda case: f"{case.key}-prepared", _prepared, pool, progress)


def ablations(folder: Path) -> Store[Ablation]:
    """Return the store of completed cases."""
    return Store(Ablation, folder)


def _prepared(case: Variant) -> list[Dropped]:
    return prepare(case.scene)
