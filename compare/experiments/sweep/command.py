"""`--sweep` of a command: from what the user gives to the table."""

from __future__ import annotations

from contextlib import ExitStack
from pathlib import Path
from typing import Any, NamedTuple

from cases.errors import SceneError
from cases.read import parse_override
from compare.cli import terminal
from compare.cli.options import warn
from compare.experiments.cost import dry_run
from compare.experiments.cost.run_cost import Forecast, forecast
from compare.experiments.pool import on_pool
from compare.experiments.sweep import runner, show, table
from compare.experiments.sweep.axis import Axis, axes
from compare.experiments.sweep.case import Case, Work
from compare.runs.checkpoint.lock import locked
from compare.runs.processes import started


class Asked(NamedTuple):
    """A sweep: the scene's name, what is swept, every case of it, and the folder; None writes
    nothing."""

    scene: str
    axes: list[Axis]
    cases: list[Case]
    out: Path | None


def ask(
    scene: str, changes: list[str], variant: str | None, given: list[str], out: Path | None
) -> Asked:
    """Return what `--sweep` asks for; raises SceneError, in one line."""
    fixed = dict(parse_override(text) for text in changes)
    found = axes(given, list(fixed))
    wanted = runner.cases_of(scene, fixed, variant, found, out or Path())
    return Asked(scene, found, wanted, out)


def sweep(
    asked: Asked, work: Work, workers: int, dry: bool, as_json: bool, strict: bool = False
) -> None:
    """Run every case, write the table, and show it; dry : only say what would run.

    strict : refuse scenes that are warned of. Raises SceneError where all fail.
    """
    warn([case.scene for case in asked.cases if case.scene is not None], strict)
    if dry:
        _foresee(asked, work, as_json)
        return
    processes = started()
    with ExitStack() as held, terminal.progress(f"{len(asked.cases)} points") as advance:
        if asked.out is not None:
            place = asked.out
            processes.by_first(lambda: held.enter_context(locked(place)))
        found = on_pool(
            processes,
            workers,
            lambda pool: runner.run(asked.cases, work, asked.out, pool, advance),
        )
    if found is None:  # not the first process
        return
    if all(one.state == "failed" for one in found):
        allowed = f"all {len(found)} points fail: {found[0].message}"
        raise SceneError(asked.scene, "", None, allowed)
    rows = table.frame(asked.axes, asked.cases, found)
    about = {"scene": asked.scene}
    files = [] if asked.out is None else table.write_table(asked.out, asked.axes, rows, about)
    show.show_sweep(asked.axes, rows, files, as_json)


def _foresee(asked: Asked, work: Work, as_json: bool) -> None:
    """Show what every case would take, and which would fail before they begin."""
    found: list[tuple[str, Forecast]] = []
    failing: list[tuple[str, str]] = []
    with terminal.progress(f"{len(asked.cases)} points") as advance:
        for i, case in enumerate(asked.cases):
            point = ", ".join(f"{k}={v}" for k, v in case.settings.items())
            if case.scene is None:
                failing.append((point, case.message))
                continue
            try:
                found += [(point, one) for one in _forecasts(case, work)]
            except SceneError as error:
                failing.append((point, str(error)))
            advance((i + 1) / len(asked.cases))
    dry_run.show_forecasts(found, as_json, failing)


def _forecasts(case: Case, work: Work) -> list[Any]:
    assert case.scene is not None
    return [forecast(case.scene, name) for name in work.solvers(case)]
