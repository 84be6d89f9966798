"""All studies by name: studies in TOML files, hard cases, and scattering of waves at joints."""

from pathlib import Path

from jointwave.compare.studies import hard_cases, scattering, work_precision
from jointwave.compare.studies.experiment import Experiment
from jointwave.compare.studies.study import load, shipped


def experiment(name: str, out: Path, brief: bool = False) -> Experiment:
    """Return a study by its name or file, with points in OUT/NAME/ and tables in `out`.

    brief : scattering only: use every other point. Raises SceneError for an unknown study.
    """
    if name == hard_cases.NAME:
        return hard_cases.experiment(out)
    if name in scattering.TITLES:
        return scattering.experiment(name, out, brief)
    return work_precision.experiment(load(name), out / Path(name).stem)


def listed() -> list[dict[str, str]]:
    """Return the name and title of every study; for studies in files also the scene."""
    studies = {name: load(name) for name in shipped()}
    in_code = {hard_cases.NAME: hard_cases.TITLE, **scattering.TITLES}
    of_files = [{"study": k, "title": s.title, "scene": s.scene} for k, s in studies.items()]
    return of_files + [{"study": name, "title": title} for name, title in in_code.items()]
