"""The command `jointwave fit`."""

import math
import shlex
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from jointwave.cases.errors import SceneError
from jointwave.cases.scene_type import AnyScene
from jointwave.compare.cli import terminal
from jointwave.compare.cli.options import (
    Engine,
    JsonOption,
    ModelOption,
    SceneArgument,
    SetOption,
    StrictOption,
    VariantOption,
    WithOption,
    app,
    load,
    warn,
)
from jointwave.compare.runs import jobs

if TYPE_CHECKING:
    from jointwave.compare.studies.fit import Estimate, Fit


@app.command()
def fit(
    scene: SceneArgument,
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
        Engine | None, typer.Option(help="Solver of the scene (default: rigid blocks).")
    ] = None,
    model: ModelOption = None,
    changes: SetOption = [],
    variant: VariantOption = "",
    out: Annotated[Path | None, typer.Option(help="Folder of a table, fit.csv.")] = None,
    strict: StrictOption = False,
    as_json: JsonOption = False,
) -> None:
    """Fit keys of a scene to measured waveforms by least squares, with 95 % intervals.

    --free names keys by their dotted path, joints.normal_stiffness or
    soft_layers.0.spacing_stiffness, optionally with start and bounds:
    KEY=START or KEY=LOW:START:HIGH. clock is a shift of the times of the files, s,
    started from cross-correlation. --with is that of compare: quantity, place, sign
    and unit of every column; amplitudes are never scaled.

    Without --engine the scene is solved by rigid blocks, exactly in time (lattice) where that
    applies and the chain is short. In a rock mass keys are joint_sets.0.normal_stiffness or
    waves.0.amplitude, and waveforms those of its points and joints.

    Intervals assume independent residuals; keys that the waveforms cannot distinguish, and
    keys that stop at a bound, are named. A search that does not converge ends with exit code 3.

    --out writes fit.csv: values, intervals and correlations. The last line printed is a command
    that compares the fitted scene with the same files, with figures.
    """
    from jointwave.compare.misfit.external import read_curves, slips
    from jointwave.compare.runs.output import write_csv
    from jointwave.compare.studies.fit import fit as fitted
    from jointwave.compare.studies.fit import table

    (one,) = load(scene, changes, variant or "", strict)
    curves = read_curves(given, [one])
    warn([one], strict, lambda scene: slips(curves, scene))
    solver = _solver(one, engine, model)
    with terminal.progress(one.name or one.title) as advance:
        found = fitted(one, curves, free, solver, advance)
    files = [write_csv(out / "fit.csv", table(found), 12)] if out is not None else []
    if as_json:
        terminal.print_json({**_facts(found), "files": list(map(str, files))})
    else:
        _show(found, scene, given, changes)
        for path in files:
            terminal.say(f"wrote {path}")


def _solver(scene: AnyScene, engine: Engine | None, models: list[str] | None) -> str | None:
    """Return the solution selected by --engine and --model; None without them."""
    if engine is None and not models:
        return None
    if engine is None:
        engine = Engine(jobs.engine_of((models or [""])[0]))
    ((of, model), *more) = jobs.wanted([engine.value], models or [])
    found = jobs.names_of(of, model, scene)
    if more or len(found) > 1:
        allowed = f"must be one of {', '.join(found)}" if not more else "must be given once"
        raise SceneError("--model", "", None, allowed)
    return found[0]


def _show(found: "Fit", scene: str, given: list[str], changes: list[str]) -> None:
    """Print values with intervals, misfits, and the command to continue."""
    name = f"{found.scene.title} {found.scene.name}".strip()
    terminal.say(f"{name}, fitted by {found.solver} in {found.trials} solutions", "bold")
    worst = max(found.waveforms, key=lambda one: one.after)
    terminal.say(
        f"misfit {found.before:.3%} before, {found.after:.3%} after"
        + (f"; worst {worst.name}, {worst.place}" if len(found.waveforms) > 1 else "")
    )
    terminal.show_numbers(
        ["key", "value", "from", "to", "start"],
        {"values, with 95 % intervals": [_cells(e) for e in found.estimates]},
    )
    for note in found.notes:
        terminal.say(f"note: {note}")
    terminal.say("The intervals assume the model: jointwave compare shows how far models differ.")
    arguments = ["jointwave", "compare", scene, "--variant", found.scene.name]
    arguments += [part for setting in [*changes, *found.settings] for part in ("--set", setting)]
    arguments += [part for file in given for part in ("--with", file)]
    arguments += ["--align"] * any(e.key == "clock" for e in found.estimates)
    terminal.say(f"compare: {shlex.join(arguments)}")


def _facts(found: "Fit") -> dict[str, Any]:
    """Return a fit for JSON, which has null for unbounded values."""
    of = ("name", "before", "after")
    return {
        "title": found.scene.title,
        "variant": found.scene.name,
        "solver": found.solver,
        "keys": [e._asdict() for e in found.estimates],
        "correlation": found.correlation.tolist(),
        "waveforms": [
            {"place": str(one.place)} | {key: getattr(one, key) for key in of}
            for one in found.waveforms
        ],
        "trials": found.trials,
        "notes": found.notes,
        "set": found.settings,
    }


def _cells(e: "Estimate") -> list[str]:
    if not math.isfinite(e.high):
        return [e.key, f"{e.value:.6g}", "not", "determined", f"{e.start:.6g}"]
    half = (e.high - e.low) / 2 or abs(e.value)
    digits = 3 + max(0, math.ceil(math.log10(abs(e.value) / half))) if e.value else 6
    numbers = [f"{x:.{min(digits, 10)}g}" for x in (e.value, e.low, e.high)]
    return [e.key, *numbers, f"{e.start:.6g}"]
