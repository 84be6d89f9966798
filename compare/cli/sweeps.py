"""`--sweep` and `--ensemble` of `jointwave run` and `jointwave compare`."""

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

from jointwave.cases.scene_type import AnyScene
from jointwave.compare.cli.forecast import Run, runs_of, show_forecasts
from jointwave.compare.cli.inputs import warn
from jointwave.compare.cli.studies import run_and_show
from jointwave.compare.runs.reuse import ResultFolder
from jointwave.compare.studies.sweep import Work, cases_of, experiment


def sweep(
    asked: Any,
    out: Path | None,
    work_of: Callable[[list[AnyScene]], Work],
    solvers: Callable[[AnyScene], Iterable[str]],
    parts: Iterable[str] = (),
) -> None:
    """Run every case of a sweep and show its table, or only estimates.

    asked : the options of `run` or `compare`. work_of : returns what is done with a case, for the
    scenes of all. solvers : returns the names of a scene's solvers. parts : what else each case
    does, see `show_forecasts`. Raises SceneError if all cases fail.
    """
    cases = cases_of(asked.scene, asked.changes, asked.variant, asked.swept, out, asked.members)
    scenes = [case.scene for case in cases if case.scene is not None]
    work = work_of(scenes)
    warn(scenes, asked.strict)
    if asked.dry:
        runs: list[Run] = []
        for case in cases:
            if case.scene is not None:
                stored = ResultFolder(case.folder, asked.fresh)
                runs += runs_of(solvers(case.scene), case.scene, stored, point=case.point)
        failing = {case.point: case.message for case in cases if case.scene is None}
        others = {"processes": asked.workers * (asked.workers > 1)}
        others |= dict.fromkeys(parts, len(scenes))
        show_forecasts(runs, asked.as_json, others, failing)
        return
    one = experiment(asked.scene, cases, out, asked.fresh, work)
    run_and_show(one, out, asked.workers, asked)
