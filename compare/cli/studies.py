"""Commands of many runs: `jointwave study`, `effects`, `plan`, `fit`, and all with `--sweep`."""

import shlex
from collections.abc import Callable, Iterable
from contextlib import ExitStack
from pathlib import Path
from typing import Any

from jointwave.cases.errors import SceneError
from jointwave.cases.scene_type import AnyScene
from jointwave.compare.cli import terminal
from jointwave.compare.cli.commands import Effects, Fit, Plan, Study
from jointwave.compare.cli.forecast import Run, runs_of, show_forecasts
from jointwave.compare.cli.inputs import load, warn
from jointwave.compare.cli.options import CORES, PrintOptions
from jointwave.compare.engines import label_of
from jointwave.compare.misfit.external import doubts, read_curves
from jointwave.compare.runs import jobs
from jointwave.compare.runs.checkpoint.lock import locked
from jointwave.compare.runs.output import write_csv
from jointwave.compare.runs.processes import started
from jointwave.compare.runs.reuse import ResultFolder
from jointwave.compare.studies import catalogue
from jointwave.compare.studies import effects as measuring
from jointwave.compare.studies import fit as fits
from jointwave.compare.studies import plan as plans
from jointwave.compare.studies.experiment import Experiment
from jointwave.compare.studies.fit_keys import unit_of
from jointwave.compare.studies.measure import Reference
from jointwave.compare.studies.store import on_pool
from jointwave.compare.studies.sweep import Work, experiment
from jointwave.compare.studies.sweep_keys import cases_of
from jointwave.compare.text import percent


def study(asked: Study) -> None:
    """Run a study and show its summary; without a name, list the studies."""
    if asked.name is None:
        found = catalogue.listed()
        terminal.print_json(found) if asked.as_json else terminal.show_facts({"studies": found})
        return
    one = catalogue.experiment(asked.name, asked.out)
    run_and_show(one, asked.out / Path(asked.name).stem, asked.workers, asked)


def effects(asked: Effects) -> None:
    """Measure the effects of a scene and show their summary."""
    wanted = [(asked.scene, one) for one in load(asked, every=False)]
    one = measuring.experiment(wanted[0][1].title, wanted, asked.out)
    run_and_show(one, asked.out, CORES, asked)


def run_and_show(one: Experiment, out: Path | None, workers: int, shown: PrintOptions) -> None:
    """Run a study and show its summary (under MPI on the first process), or show its estimates.

    out : a folder, locked meanwhile; None writes nothing.
    """
    if shown.dry:
        others = {"diagrams": 1, "processes": workers * (workers > 1 and one.shares)}
        show_forecasts(one.planned(), shown.as_json, others)
        return
    processes = started()
    with ExitStack() as held, terminal.progress(one.title) as advance:
        if out is not None:
            processes.by_first(lambda: held.enter_context(locked(out)))
        found = on_pool(processes, workers, lambda pool: one.make(pool, advance))
    if found is None:
        return
    if shown.as_json:
        terminal.print_json(found.facts)
        return
    terminal.show_frame(found.table)
    for line in filter(None, [found.legend, *found.sentences]):
        terminal.say(line)
    for line in found.failed:
        terminal.say(f"failed: {line}", "red")
    if found.note:
        terminal.say(found.note)
    if found.files:
        terminal.say(f"written: {', '.join(map(str, found.files))}")


def sweep(
    asked: Any,
    out: Path | None,
    work_of: Callable[[list[AnyScene]], Work],
    solvers: Callable[[AnyScene], Iterable[str]],
    parts: Iterable[str] = (),
) -> None:
    """Run every case of a sweep and show its table, or only estimates.

    asked : the options of `run` or `compare`. work_of : returns the work for a case, given the
    scenes of all cases. solvers : returns the names of a scene's solvers. parts : other tasks of
    each case, see `show_forecasts`. Raises SceneError if all cases fail.
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


def plan(asked: Plan) -> None:
    """Find the cheapest run that meets a misfit, and print its command."""
    for scene in load(asked, every=False):
        with terminal.progress(scene.name or scene.title) as advance:
            found = plans.plan(scene, asked.misfit, asked.seconds, advance)
        _show_plan(found, asked)


def _show_plan(one: plans.Plan, asked: Plan) -> None:
    terminal.say(", ".join(filter(None, [one.scene.title, one.scene.name])))
    why = "" if one.finest.settings else f" ({one.reason})"
    terminal.say(f"modelling error: against {_named(one.finest)}{why}")
    best, misfit = one.chosen, percent(one.asked)
    if best is None:
        for reason in dict.fromkeys(one.skipped.values()):
            terminal.say(f"skipped: {reason}")
        why = "no engine's model is close enough to finest physics in time"
        terminal.say(f"{misfit} % is not met: {why}")
        return
    terminal.say(f"numerical error: against {_named(best.reference)}, the engine's own model")
    errors = [percent(x) for x in (best.numerical, best.modelling, best.misfit, one.misfit)]
    columns = ["numerical", "modelling", "sum", "sum with smaller steps"]
    columns = ["engine", *(f"{name} (%)" for name in columns), "stepping (s)"]
    terminal.show_table(columns, [[label_of(best.elements.name), *errors, f"{best.seconds:.3g}"]])
    chosen = ["jointwave", "run", asked.scene, "--variant", one.scene.name]
    chosen += jobs.options_of(best.elements.name)
    chosen += [part for text in [*asked.changes, *best.options] for part in ("--set", text)]
    terminal.say(shlex.join(chosen))
    met = "the sum of errors meets" if one.is_met else "nearest run: the sum of errors exceeds"
    terminal.say(f"{met} {misfit} %; planning took {len(one.runs)} runs and {one.planning:.2g} s")


def _named(reference: Reference) -> str:
    """Return the reference of errors in words, with its accuracy and time limit."""
    words = label_of(reference.name) + f" at {reference.settings}" * bool(reference.settings)
    if reference.error:
        words += f", accurate to {percent(reference.error)} %"
    until = reference.result.attrs.get("known_until")
    return words if until is None else f"{words}, valid until {float(until):.3g} s"


def fit(asked: Fit) -> None:
    """Fit a scene and print its values, or print the estimated cost."""
    (scene,) = load(asked, every=False)
    curves = read_curves(asked.given, [scene])
    warn([scene], asked.strict, lambda one: doubts(curves, one))
    solver = _solver(asked, scene)
    if asked.dry:
        show_forecasts([fits.planned(scene, asked.free, solver)], asked.as_json)
        return
    with ExitStack() as held, terminal.progress(scene.name or scene.title) as advance:
        if asked.out:
            held.enter_context(locked(asked.out))
        found = fits.fit(scene, curves, asked.free, solver, advance)
    files = [write_csv(asked.out / "fit.csv", found.table.reset_index(), 12)] if asked.out else []
    values, waveforms = found.values.reset_index(), found.waveforms.astype({"place": str})
    values.insert(1, "unit", [unit_of(key, scene) for key in values.key])
    if asked.as_json:
        facts = {
            "title": scene.title,
            "variant": scene.name,
            "solver": found.solver,
            "keys": values.to_dict("records"),
            "correlation": found.correlation.values.tolist(),
            "waveforms": waveforms.to_dict("records"),
            "trials": found.trials,
            "notes": found.notes,
            "set": found.settings,
            "files": list(map(str, files)),
        }
        terminal.print_json(facts)
        return
    title = f"{scene.title} {scene.name}".strip()
    terminal.say(f"{title}, fitted by {label_of(found.solver)} ({found.trials} solutions)", "bold")
    worst = waveforms.loc[waveforms.after.idxmax()]
    where = f"; worst {worst['name']}, {worst.place}" if len(waveforms) > 1 else ""
    terminal.say(f"misfit {waveforms.before.max():.3%} before, {worst.after:.3%} after{where}")
    terminal.say("values, with 95 % intervals", "bold")
    cells = values[["key", "unit", "value", "low", "high", "start"]]
    rows = cells.map(lambda x: x if isinstance(x, str) else f"{x:.6g}").values.tolist()
    terminal.show_table([*cells], rows)
    for note in found.notes:
        terminal.say(f"note: {note}")
    terminal.say("The intervals assume the model: jointwave compare shows how far models differ.")
    options = [("--set", x) for x in [*asked.changes, *found.settings]]
    options += [("--with", file) for file in asked.given]
    command = ["jointwave", "compare", asked.scene, "--variant", scene.name, *sum(options, ())]
    terminal.say(f"compare: {shlex.join(command + ['--align'] * ('clock' in found.values.index))}")


def _solver(asked: Fit, scene: AnyScene) -> str | None:
    """Return the solution selected by --engine and --model; None without them."""
    models = asked.model or []
    if asked.engine is None and not models:
        return None
    of = asked.engine.value if asked.engine else jobs.engine_of(models[0])
    found = [name for run in jobs.wanted([of], models) for name in jobs.names_of(*run, scene)]
    if len(found) > 1:
        raise SceneError("--model", "", None, f"must be one of {', '.join(found)}")
    return found[0]
