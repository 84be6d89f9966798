"""`--sweep` of a command: estimates of the runs, or their table."""

from compare.cli.options import warn
from compare.engines import Progress
from compare.experiments.cost import dry_run
from compare.experiments.pool import Pool
from compare.experiments.summary import Summary, run_and_show
from compare.experiments.sweep import runner
from compare.experiments.sweep.case import Work
from compare.experiments.sweep.runner import Sweep
from compare.experiments.sweep.summary import summarise


def sweep(
    asked: Sweep, work: Work, workers: int, dry: bool, as_json: bool, strict: bool = False
) -> None:
    """Run every case, write the table, and show it; dry : only print estimates.

    strict : treat warnings as errors. Raises SceneError if all cases fail.
    """
    warn(asked.scenes, strict)
    if dry:
        _foresee(asked, work, as_json)
        return

    def done(pool: Pool | None, advance: Progress) -> Summary:
        return summarise(asked, runner.run(asked, work, pool, advance))

    run_and_show(f"{len(asked.cases)} points", asked.out, workers, done, as_json)


def _foresee(asked: Sweep, work: Work, as_json: bool) -> None:
    """Show the estimated cost of every case, and cases that would fail at once."""
    wanted: list[dry_run.Run] = []
    failing: list[tuple[str, str]] = []
    for case in asked.cases:
        point = ", ".join(f"{k}={v}" for k, v in case.settings.items())
        if case.scene is None:
            failing.append((point, case.message))
        else:
            wanted += [(point, case.scene, name) for name in work.solvers(case.scene)]
    dry_run.show_runs(wanted, as_json, failing)
