"""Run a sweep: every variant at every point once, on any executor."""

from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

from cases.errors import SceneError
from cases.read import parse_override
from compare.engines import Progress
from compare.experiments.common import combinations
from compare.experiments.sweep.axis import axes
from compare.experiments.sweep.case import SweepCase, SweepOutcome, Work, key, outcome
from compare.experiments.sweep.ensemble import MEMBER, member
from compare.scenes import find, load, load_variant
from compare.studies.store import DIED, Pool, Store

POINTS = "points"  # the folder of completed points
LONGEST = 100  # characters of a folder's name
LOST = SweepOutcome("failed", DIED, [])


class Sweep(NamedTuple):
    """A sweep of a scene.

    scene : its name. axes : the values by swept key. cases : all variants at every point. out : the
    folder; None writes nothing.
    """

    scene: str
    axes: dict[str, list[Any]]
    cases: list[SweepCase]
    out: Path | None

    @property
    def scenes(self) -> list[Any]:
        """The scenes of all cases that have one."""
        return [case.scene for case in self.cases if case.scene is not None]


def sweep_of(
    scene: str,
    changes: list[str],
    variant: str | None,
    given: list[str],
    out: Path | None,
    members: int = 0,
) -> Sweep:
    """Return the sweep of `--set`, `--variant`, `--sweep` and `--ensemble`; raises SceneError in
    one line, also if no point has a valid scene."""
    fixed = dict(map(parse_override, changes))
    values = axes(given, list(fixed), members)
    path, found, errors = find(scene), [], []
    for i, setting in enumerate(combinations(values)):
        folder, overrides = (out or Path()) / _folder(setting, i), {**fixed, **setting}
        try:
            if members:
                number = overrides.pop(MEMBER)
                overrides |= member(load_variant(path, variant or "", overrides), number)
            scenes = (
                load(path, overrides)
                if variant is None
                else [load_variant(path, variant, overrides)]
            )
        except SceneError as error:
            errors.append(error)
            found.append(SweepCase(setting, folder, None, str(error)))
        else:
            found += [SweepCase(setting, folder, one) for one in scenes]
    if errors and len(errors) == len(found):
        raise errors[0]
    return Sweep(scene, values, found, out)


def _folder(setting: dict[str, Any], number: int) -> str:
    """Return the name of a point's folder: its values, or its number if they are no valid name."""
    name = ",".join(f"{k}={v}" for k, v in setting.items())
    plain = name.isprintable() and not set(name) & set("/\\") and len(name.encode()) <= LONGEST
    single = not any(isinstance(value, list | dict) for value in setting.values())
    return name if plain and single else f"point-{number + 1:05d}"


def run(
    asked: Sweep, work: Work, pool: Pool | None = None, progress: Progress | None = None
) -> list[SweepOutcome]:
    """Return the outcomes of all cases, in order; completed ones are read from its folder."""

    def has_files(found: SweepOutcome) -> bool:
        return all(Path(str(row["file"])).is_file() for row in found.rows if "file" in row)

    folder = asked.out and asked.out / POINTS
    outcomes: Store[SweepOutcome] = Store(SweepOutcome, folder, has_files)
    key_of, outcome_of = partial(key, work=work), partial(outcome, work=work)
    return outcomes.compute(asked.cases, key_of, outcome_of, pool, progress, lost=lambda case: LOST)
