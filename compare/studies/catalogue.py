"""The studies by name: those of a file, the hard cases, and the scattering of waves at joints."""

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import NamedTuple

from jointwave.compare.engines import Progress
from jointwave.compare.studies import hard_cases, scattering, work_precision
from jointwave.compare.studies.forecast import Run
from jointwave.compare.studies.store import Pool
from jointwave.compare.studies.study import load, shipped
from jointwave.compare.studies.summary import Summary


class Experiment(NamedTuple):
    """A study: `planned` returns its runs that are not saved yet, `make` runs it, writes its files
    and returns its summary; `shares` : whether several processes may do so at a time."""

    title: str
    planned: Callable[[], list[Run]]
    make: Callable[[Pool | None, Progress | None], Summary]
    shares: bool = True


def experiment(name: str, out: Path, brief: bool = False) -> Experiment:
    """Return a study by its name or file, with points in OUT/NAME/ and tables in `out`.

    brief : of waves at joints, only every other point. Raises SceneError for an unknown study.
    """
    folder = out / Path(name).stem
    if name == hard_cases.NAME:
        make = partial(hard_cases.make_study, out)
        return Experiment(hard_cases.TITLE, partial(hard_cases.planned, out), make)
    if name in scattering.TITLES:
        planned = partial(scattering.planned, name, folder, brief)
        make = partial(scattering.make_study, name, out, brief)
        return Experiment(scattering.TITLES[name], planned, make)
    study = load(name)
    planned = partial(work_precision.planned, study, folder)
    make = partial(work_precision.make_study, study, folder)
    return Experiment(study.title, planned, make, not study.timed)


def listed() -> list[dict[str, str]]:
    """Return the name and the title of every study, and the scene of those of a file."""
    studies = {name: load(name) for name in shipped()}
    in_code = {hard_cases.NAME: hard_cases.TITLE, **scattering.TITLES}
    of_files = [{"study": k, "title": s.title, "scene": s.scene} for k, s in studies.items()]
    return of_files + [{"study": name, "title": title} for name, title in in_code.items()]
