"""`jointwave figure`: the waveforms of a scene, drawn for a paper."""

from jointwave.compare.cli import terminal
from jointwave.compare.cli.commands import Figure
from jointwave.compare.cli.compare import curves_of
from jointwave.compare.cli.forecast import runs_of, show_forecasts
from jointwave.compare.cli.inputs import load, stored_in
from jointwave.compare.engines import applies
from jointwave.compare.figures.charts import waveforms
from jointwave.compare.figures.export import write_drawing
from jointwave.compare.figures.style import printed
from jointwave.compare.misfit.alignment import align_curve
from jointwave.compare.misfit.ranking import applicable
from jointwave.compare.runs import comparison, jobs
from jointwave.compare.runs.output import check_out


def figure(asked: Figure) -> None:
    """Solve a scene and draw its waveforms, or print what that would cost."""
    check_out(asked.out)
    rc = printed(asked.width, asked.font_size)
    scenes, runs = load(asked), []
    if asked.engine or asked.model:
        runs = jobs.wanted([e.value for e in asked.engine], asked.model or [])
    curves = curves_of(asked.given, scenes, asked.strict)
    folder, found = stored_in(asked), []
    named = [[name for run in runs for name in jobs.names_of(*run, one)] for one in scenes]
    if asked.dry:
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
    whole = waveforms.figure(found, asked.width, asked.font_size)
    terminal.say(f"wrote {write_drawing(asked.out, whole, scenes[0].title, rc)}")
