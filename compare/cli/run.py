"""`jointwave run`: the runs of a scene, their cost, and the files of their results."""

from contextlib import ExitStack
from functools import partial

from jointwave.cases.errors import SceneError
from jointwave.cases.scene_type import AnyScene
from jointwave.compare.cli import terminal
from jointwave.compare.cli.commands import Run
from jointwave.compare.cli.inputs import load, results_of, warn
from jointwave.compare.engines import label_of
from jointwave.compare.runs import jobs
from jointwave.compare.runs import run as runs
from jointwave.compare.runs.checkpoint.lock import locked
from jointwave.compare.runs.checkpoint.resume import CheckpointSettings
from jointwave.compare.runs.checkpoint.signals import watched
from jointwave.compare.runs.processes import started
from jointwave.compare.runs.reuse import ResultFolder

LABELS = {"from_y": "from (m)", "to_y": "to (m)", "mass": "mass (kg)", "velocity": "velocity (m/s)"}
LABELS |= {"seconds_stepping": "stepping (s)", "energy_residual": "energy residual (of the work)"}
BELOW = ("fragments", "static_out_of_balance", "fields")  # facts printed below the table


def run(asked: Run) -> None:
    """Run a scene or every case of a sweep, or print the estimated cost."""
    if asked.fresh and asked.resume:
        allowed = "computes anew what --resume would continue: give one of them"
        raise SceneError("--fresh", "", None, allowed)
    out = results_of(asked.scene, asked.out)
    wanted = jobs.wanted([e.value for e in asked.engine], asked.model or [])
    if asked.swept or asked.members:
        from jointwave.compare.cli.studies import sweep
        from jointwave.compare.studies.sweep import run_scene

        def solvers(one: AnyScene) -> list[str]:
            return [job.name for job in jobs.plan([one], wanted, out)[0]]

        sweep(asked, out, lambda _: partial(run_scene, runs=wanted), solvers)
        return
    scenes = load(asked)
    todo, left_out = jobs.plan(scenes, wanted, out)
    warn(scenes[:1], asked.strict, lambda _: map(str, left_out))
    if asked.dry:
        from jointwave.compare.cli.forecast import runs_of, show_forecasts

        stored = ResultFolder(out, asked.fresh)
        found = [one for job in todo for one in runs_of([job.name], job.scene, stored)]
        found = [one._replace(for_paraview=True, may_fail=False) for one in found]
        show_forecasts(found, asked.as_json)
        return
    processes = started()
    folders = {job.path.parent for job in todo}
    settings = CheckpointSettings(asked.every, asked.resume, watched(), asked.fresh)
    with ExitStack() as held, terminal.progress(f"{len(todo)} runs") as advance:
        processes.by_first(lambda: held.enter_context(locked(out, *folders)))
        done = runs.execute(todo, advance, processes, settings)
    processes.by_first(lambda: show_runs(done, asked.as_json))


def show_runs(done: list[runs.Done], as_json: bool) -> None:
    """Print the runs, their cost and their files."""
    terminal.say_warnings(f"{d.job.scene.name}: {d.ledger}".lstrip(": ") for d in done if d.ledger)
    if as_json:
        terminal.print_json([one.facts for one in done])
        return
    facts = [one.facts | {"engine": label_of(one.job.name)} for one in done]
    rows = [{key: x for key, x in one.items() if key not in BELOW} for one in facts]
    terminal.show_facts({"runs": rows}, LABELS)
    for one in done:
        name, pieces = one.job.scene.name or label_of(one.job.name), one.facts["fragments"]
        if (ratio := one.facts["static_out_of_balance"]) is not None:
            terminal.say(f"{name}: starts at rest, out-of-balance force ratio {ratio:.1e}")
        if pieces is not None:
            terminal.say(f"{name}: {len(pieces) - 1 or 'no'} joints broke")
            terminal.show_facts({"fragments": pieces[1:] and pieces}, LABELS)
        for path in one.facts["fields"]:
            terminal.say(f"{name}: snapshots for ParaView, {path}")
        if one.job.scene.record.fields is not None and not one.facts["fields"]:
            terminal.say(f"{name}: no snapshots: the solution is known at the receivers only")
