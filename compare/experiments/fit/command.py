"""The command `jointwave fit`."""

from contextlib import ExitStack
from pathlib import Path
from typing import Annotated

import typer

from cases.errors import SceneError
from cases.kinds import AnyScene
from compare.cli.options import (
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
    changes: SetOption = [],  # noqa: B006
    variant: VariantOption = "",
    out: Annotated[
        Path | None, typer.Option(help="Also write table, fitted scene, curves and figure.")
    ] = None,
    strict: StrictOption = False,
    as_json: JsonOption = False,
) -> None:
    """Fit keys of a scene to measured waveforms by least squares, with 95 % intervals.

    --free names keys by their dotted path, joints.normal_stiffness or
    soft_layers.0.spacing_stiffness, optionally with start and bounds:
    KEY=START, KEY=LOW:HIGH or KEY=LOW:START:HIGH. clock is a shift of the times of the files, s,
    started from cross-correlation. --with is that of compare: quantity, place, sign
    and unit of every column; noise needs no removal, amplitudes are never scaled.

    Without --engine the scene is solved by rigid blocks, exactly in time (lattice) where that
    applies and the chain is short. In a rock mass keys are joint_sets.0.normal_stiffness or
    waves.0.amplitude, and waveforms those of its points and joints.

    Intervals account for correlated residuals; keys that the waveforms cannot distinguish, and
    keys that stop at a bound, are named. A search that does not converge ends with exit code 3.

    --out writes fit.csv, fit.json, fitted.toml, a runnable scene, and fit-waveforms as SVG, PDF,
    PNG and CSV, with the residual below each waveform.
    """
    from compare.cli import terminal
    from compare.experiments.fit.fit import fit as fitted
    from compare.experiments.fit.show import show_fit
    from compare.misfit.external import read_curves, slips
    from compare.runs.checkpoint.lock import locked

    (one,) = load(scene, changes, variant or "", strict)
    curves = read_curves(given, [one])
    warn([one], strict, lambda scene: slips(curves, scene))
    solver = _solver(one, engine, model)
    with ExitStack() as held:
        if out is not None:
            held.enter_context(locked(out))
        with terminal.progress(one.name or one.title) as advance:
            found = fitted(one, curves, free, solver, advance)
        from compare.experiments.fit.files import facts, write_fit

        files = write_fit(found, one, out) if out is not None else []
    if as_json:
        terminal.print_json({**facts(found), "files": list(map(str, files))})
    else:
        show_fit(found, scene, changes, files)


def _solver(scene: "AnyScene", engine: Engine | None, models: list[str] | None) -> str | None:
    """Return the solution selected by --engine and --model; None without them."""
    from compare.runs import jobs

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
