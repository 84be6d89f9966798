"""Commands that put the solutions of a scene side by side: as distances, or drawn."""

from functools import partial
from pathlib import Path
from typing import Annotated, Any

import typer

from jointwave.cases.errors import SceneError
from jointwave.cases.scene_type import AnyScene
from jointwave.compare.cli import terminal
from jointwave.compare.cli.options import (
    DryOption,
    EngineOption,
    ModelOption,
    PrintOptions,
    SceneOptions,
    StoredOptions,
    SweepOptions,
    WithOption,
    command,
    warn,
)


@command
def compare(
    asked: SceneOptions,
    sweeps: SweepOptions,
    stored: StoredOptions,
    shown: PrintOptions,
    every: Annotated[
        bool, typer.Option("--all", help="Also every misfit, and why other solutions do not apply.")
    ] = False,
    reads: Annotated[
        bool, typer.Option("--read", help="Also peak velocity, Arias intensity, spectra, speeds.")
    ] = False,
    out: Annotated[
        Path | None,
        typer.Option(help="Folder for tables, curves, figure and, without --results, results."),
    ] = None,
    spectral: Annotated[
        bool, typer.Option(help="Add envelope and phase misfit (Kristekova et al. 2006).")
    ] = True,
    given: WithOption = [],
    align: Annotated[
        bool, typer.Option("--align", help="Align each --with curve by cross-correlation.")
    ] = False,
) -> None:
    """Solve a scene by all that applies; say how far apart, and why.

    Prints a line per engine: its worst misfit from the finest physics, with variant and receiver,
    its reference, its own numerical error, the stepping time, and the verdict. --all, --json, --out
    and --with also run all other solvers. --all prints the misfit of every pair, and the peak ratio
    of data and model for external curves.

    --with adds a waveform of another code, figure or experiment: a table with a header such as
    "time [ms], stress@20 [MPa]", a seismogram, or a NetCDF file. A label names the curve of a file
    without names, or selects one of several: curve.csv:stress@20, "run.nc:-velocity@20.25 [mm/s]".
    With the header of a column in front it selects that column: "gauge.csv:CH 3=stress@20 [MPa]".
    Receivers of a rock mass have two coordinates: "velocity_x@[20,30]", "stress_xx@[20,30] [MPa]",
    "gap@[20,20]". The default unit is SI. Stress is positive in compression; a minus sign inverts
    a curve. Only the overlap in time is compared. Amplitudes are never scaled; times are shifted
    only by --align.

    --sweep compares the scene for every value of a key, in several processes, and writes one
    table. --ensemble compares a scene with random joints for several seeds, with statistics.
    """
    from jointwave.compare.cli.comparison_view import show_comparisons
    from jointwave.compare.misfit.ranking import applicable, deciding
    from jointwave.compare.runs import comparison

    if sweeps.swept or sweeps.members:
        from jointwave.compare.cli.study_view import sweep
        from jointwave.compare.studies.sweep import compare_scene

        def work_of(scenes: list[AnyScene]) -> Any:
            curves = _read_curves(given, scenes, align, asked.strict)
            return partial(compare_scene, spectral=spectral, curves=curves, align=align)

        writes = ("distances", "tables")[: 1 if out is None else 2]
        sweep(asked, sweeps, out, stored.fresh, work_of, applicable, shown, writes)
        return
    scenes = asked.load()
    curves = _read_curves(given, scenes, align, asked.strict)
    folder = stored.folder(asked.scene, out)
    shows_all = every or shown.as_json or out is not None or bool(curves)
    if shown.dry:
        from jointwave.compare.cli.forecast_view import show_forecasts
        from jointwave.compare.studies.forecast import runs_of

        wanted = applicable if shows_all else deciding
        runs = [run for one in scenes for run in runs_of(wanted(one), one, folder)]
        parts = {"distances": len(scenes) * shows_all, "tables": len(scenes) * bool(out)}
        show_forecasts(runs, shown.as_json, parts)
        return
    found = []
    for one in scenes:
        with terminal.progress(one.name or one.title) as advance:
            if shows_all:
                found.append(comparison.compare(one, curves, advance, align, spectral, folder))
            else:
                found.append(comparison.solved(one, deciding(one), advance, folder))
    if out is not None:
        from jointwave.compare.figures.tables import write_comparisons

        write_comparisons(found, out)
    show_comparisons(found, every, shown.as_json, reads)


@command
def figure(
    asked: SceneOptions,
    stored: StoredOptions,
    out: Annotated[Path, typer.Option(help="Output file: .pdf, .svg or .png.")],
    engine: EngineOption = [],
    model: ModelOption = None,
    given: WithOption = [],
    width: Annotated[float, typer.Option(min=60, max=1000, help="Width, mm.")] = 90.0,
    font_size: Annotated[float, typer.Option(min=4, max=40, help="Size of letters, pt.")] = 8.0,
    dry: DryOption = False,
) -> None:
    """Draw the waveforms of a scene as a figure for a paper.

    A panel for each variant and receiver, two side by side from a width of 170 mm. Files need no
    installed fonts. Without --engine, all solvers that apply are drawn.
    """
    from jointwave.compare.engines import applies
    from jointwave.compare.figures.charts import waveforms
    from jointwave.compare.figures.export import write_drawing
    from jointwave.compare.figures.style import printed
    from jointwave.compare.misfit.alignment import align_curve
    from jointwave.compare.misfit.ranking import applicable
    from jointwave.compare.runs import comparison, jobs
    from jointwave.compare.runs.output import check_out

    check_out(out)
    rc = printed(width, font_size)
    scenes = asked.load()
    runs = jobs.wanted([e.value for e in engine], model or []) if engine or model else []
    curves = _read_curves(given, scenes, False, asked.strict)
    folder, found = stored.folder(asked.scene), []
    named = [[name for run in runs for name in jobs.names_of(*run, one)] for one in scenes]
    if dry:
        from jointwave.compare.cli.forecast_view import show_forecasts
        from jointwave.compare.studies.forecast import runs_of

        both = zip(scenes, named, strict=True)
        wanted = [run for one, of in both for run in runs_of(of or applicable(one), one, folder)]
        show_forecasts(wanted, False, {"figures": len(scenes)})
        return
    for one, names in zip(scenes, named, strict=True):
        with terminal.progress(one.name or one.title) as advance:
            answers = {name: applies(name, one) for name in names} or applicable(one)
            drawn = comparison.solved(one, answers, advance, folder)
            drawn.besides += [align_curve(x, one, drawn.results, False) for x in curves]
            found.append(drawn)
    whole = waveforms.figure(found, width, font_size)
    terminal.say(f"wrote {write_drawing(out, whole, scenes[0].title, rc)}")


def _read_curves(given: list[str], scenes: list[AnyScene], align: bool, strict: bool) -> list[Any]:
    """Read what `--with` names; what is wrong with it is said before anything is solved."""
    if not given:
        if align:
            raise SceneError("--align", "", None, "needs --with: there is no curve to align")
        return []
    from jointwave.compare.misfit.alignment import common_times
    from jointwave.compare.misfit.external import doubts, read_curves

    curves = read_curves(given, scenes)
    if not align:
        for scene in scenes:
            for one in curves:
                common_times(one, scene)
    warn(scenes, strict, lambda scene: doubts(curves, scene))
    return curves
