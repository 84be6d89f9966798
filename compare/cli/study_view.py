"""Studies on the terminal: their progress, and their summary."""

from collections.abc import Callable, Iterable
from contextlib import ExitStack
from pathlib import Path

from jointwave.cases.scene_type import AnyScene
from jointwave.compare.cli.forecast_view import show_forecasts
from jointwave.compare.cli.frames import show_frame
from jointwave.compare.cli.options import warn
from jointwave.compare.cli.terminal import print_json, progress, say, show_facts
from jointwave.compare.engines import Progress
from jointwave.compare.runs.checkpoint.lock import locked
from jointwave.compare.runs.processes import started
from jointwave.compare.runs.reuse import ResultFolder
from jointwave.compare.studies.forecast import Run, runs_of
from jointwave.compare.studies.store import Pool, on_pool, plain
from jointwave.compare.studies.study import load, shipped
from jointwave.compare.studies.summary import Summary
from jointwave.compare.studies.sweep import Sweep, Work, run
from jointwave.compare.studies.sweep_table import summarise


def show_studies(as_json: bool) -> None:
    """Print the shipped studies: their names, titles and scenes."""
    from jointwave.compare.studies.hard_cases import NAME, TITLE  # imports matplotlib
    from jointwave.compare.studies.scattering import TITLES

    facts = [{"study": k, "title": (one := load(k)).title, "scene": one.scene} for k in shipped()]
    facts += [{"study": name, "title": title} for name, title in {NAME: TITLE, **TITLES}.items()]
    print_json(facts) if as_json else show_facts({"studies": facts})


def run_and_show(
    label: str,
    out: Path | None,
    workers: int,
    work: Callable[[Pool | None, Progress], Summary],
    as_json: bool,
) -> None:
    """Show the summary returned by `work(pool, progress)`; of several MPI processes only the first
    does.

    label : of the progress bar. out : a folder, locked meanwhile; None writes nothing.
    """
    processes = started()
    with ExitStack() as held, progress(label) as advance:
        if out is not None:
            processes.by_first(lambda: held.enter_context(locked(out)))
        found = on_pool(processes, workers, lambda pool: work(pool, advance))
    if found is not None:
        show(found, as_json)


def sweep(
    asked: Sweep,
    work: Work,
    solvers: Callable[[AnyScene], Iterable[str]],
    workers: int,
    dry: bool,
    as_json: bool,
    strict: bool = False,
    parts: Iterable[str] = (),
) -> None:
    """Run every case of a sweep and show its table; dry : only print estimates.

    solvers : returns the names of a scene's solvers. strict : treat warnings as errors. parts :
    what else each case does, see `show_forecasts`. Raises SceneError if all cases fail.
    """
    warn(asked.scenes, strict)
    if dry:
        runs: list[Run] = []
        for case in asked.cases:
            if case.scene is not None:
                stored = ResultFolder(case.folder, asked.fresh)
                runs += runs_of(solvers(case.scene), case.scene, stored, point=case.point)
        failing = {case.point: case.message for case in asked.cases if case.scene is None}
        others = {"processes": workers * (workers > 1)} | dict.fromkeys(parts, len(asked.scenes))
        show_forecasts(runs, as_json, others, failing)
        return

    def done(pool: Pool | None, advance: Progress) -> Summary:
        return summarise(asked, run(asked, work, pool, advance))

    run_and_show(f"{len(asked.cases)} points", asked.out, workers, done, as_json)


def show(found: Summary, as_json: bool) -> None:
    """Print a summary: its table, its sentences and its files; or its facts."""
    if as_json:
        print_json(plain(found.facts))
        return
    show_frame(found.table)
    for line in filter(None, [found.legend, *found.sentences]):
        say(line)
    for line in found.failed:
        say(f"failed: {line}", "red")
    if found.note:
        say(found.note)
    if found.files:
        say(f"written: {', '.join(map(str, found.files))}")
