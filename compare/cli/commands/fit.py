"""The command `jointwave fit`."""

import shlex
from pathlib import Path
from typing import Annotated

import typer

from jointwave.cases.errors import SceneError
from jointwave.cases.scene_type import AnyScene
from jointwave.compare.cli import terminal
from jointwave.compare.cli.options import (
    Engine,
    ModelOption,
    PrintOptions,
    SceneOptions,
    WithOption,
    command,
    warn,
)
from jointwave.compare.engines import label_of
from jointwave.compare.runs import jobs


@command
def fit(
    asked: SceneOptions,
    shown: PrintOptions,
    given: WithOption,
    free: Annotated[
        list[str],
        typer.Option(
            "--free",
            metavar="KEY",
            help="A key of the scene, or clock; repeatable, or separated by commas.",
        ),
    ],
    engine: Annotated[
        Engine | None,
        typer.Option(help="dem: rigid blocks (default); continuum: rock; exact: exact solutions."),
    ] = None,
    model: ModelOption = None,
    out: Annotated[Path | None, typer.Option(help="Folder for the table fit.csv.")] = None,
) -> None:
    """Fit keys of a scene to measured waveforms by least squares.

    Values come with 95 % intervals, for independent residuals. Keys that the waveforms cannot
    distinguish and keys that stop at a bound are named. A search that does not converge ends with
    exit code 3.

    --free names keys by their dotted path, such as joints.normal_stiffness or
    soft_layers.0.spacing_stiffness, in a rock mass joint_sets.0.normal_stiffness or
    waves.0.amplitude, optionally with start and bounds: KEY=START or KEY=LOW:START:HIGH. The key
    clock is a shift of the times of the files in s, and starts from cross-correlation. --with is
    that of compare: quantity, place, sign and unit of every column. Amplitudes are never scaled.

    Without --engine the scene is solved by rigid blocks, in a short chain by their exact solution
    (lattice).

    --out writes fit.csv: values, intervals and correlations. The last line printed is a command
    that compares the fitted scene with the same files.
    """
    from jointwave.compare.cli.forecast_view import show_forecasts
    from jointwave.compare.misfit.external import doubts, read_curves
    from jointwave.compare.runs.output import write_csv
    from jointwave.compare.studies.fit import fit as fitted
    from jointwave.compare.studies.fit import planned
    from jointwave.compare.studies.fit_keys import unit_of

    (one,) = asked.load(every=False)
    curves = read_curves(given, [one])
    warn([one], asked.strict, lambda scene: doubts(curves, scene))
    solver = _solver(one, engine, model)
    if shown.dry:
        show_forecasts([planned(one, free, solver)], shown.as_json)
        return
    with terminal.progress(one.name or one.title) as advance:
        found = fitted(one, curves, free, solver, advance)
    files = [write_csv(out / "fit.csv", found.table.reset_index(), 12)] if out is not None else []
    values, waveforms = found.values.reset_index(), found.waveforms.astype({"place": str})
    values.insert(1, "unit", [unit_of(key, one) for key in values.key])
    if shown.as_json:
        facts = {
            "title": one.title,
            "variant": one.name,
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
    title = f"{one.title} {one.name}".strip()
    terminal.say(f"{title}, fitted by {label_of(found.solver)} ({found.trials} solutions)", "bold")
    worst = waveforms.loc[waveforms.after.idxmax()]
    where = f"; worst {worst['name']}, {worst.place}" if len(waveforms) > 1 else ""
    terminal.say(f"misfit {waveforms.before.max():.3%} before, {worst.after:.3%} after{where}")
    cells = values[["key", "unit", "value", "low", "high", "start"]]
    terminal.say("values, with 95 % intervals", "bold")
    terminal.show_table(
        [*cells], cells.map(lambda x: x if isinstance(x, str) else f"{x:.6g}").values.tolist()
    )
    for note in found.notes:
        terminal.say(f"note: {note}")
    terminal.say("The intervals assume the model: jointwave compare shows how far models differ.")
    arguments = ["jointwave", "compare", asked.scene, "--variant", one.name]
    arguments += [
        part for setting in [*asked.changes, *found.settings] for part in ("--set", setting)
    ]
    arguments += [part for file in given for part in ("--with", file)]
    arguments += ["--align"] * ("clock" in found.values.index)
    terminal.say(f"compare: {shlex.join(arguments)}")


def _solver(scene: AnyScene, engine: Engine | None, models: list[str] | None) -> str | None:
    """Return the solution selected by --engine and --model; None without them."""
    if engine is None and not models:
        return None
    of = engine.value if engine else jobs.engine_of((models or [""])[0])
    runs = jobs.wanted([of], models or [])
    found = [name for run in runs for name in jobs.names_of(*run, scene)]
    if len(found) > 1:
        raise SceneError("--model", "", None, f"must be one of {', '.join(found)}")
    return found[0]
