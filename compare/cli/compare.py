"""`jointwave compare`: verdicts and misfits; `jointwave report`: the same as a page."""

import json
from contextlib import nullcontext
from functools import partial
from math import isnan
from typing import Any

from jointwave.cases.errors import SceneError
from jointwave.cases.scene_type import AnyScene
from jointwave.compare.cli import terminal
from jointwave.compare.cli.commands import Compare, Report
from jointwave.compare.cli.forecast import runs_of, show_forecasts
from jointwave.compare.cli.inputs import curves_of, load, results_of, stored_in
from jointwave.compare.cli.options import SceneOptions
from jointwave.compare.cli.studies import sweep
from jointwave.compare.engines import ENGINES, in_words, label_of
from jointwave.compare.figures import tables
from jointwave.compare.misfit.pairs import GIVEN, Comparison, chaos, unit_doubts
from jointwave.compare.misfit.ranking import applicable, deciding
from jointwave.compare.report import report as pages
from jointwave.compare.report.verdict import EngineScore, engine_scores, verdict_table, verdicts
from jointwave.compare.runs import comparison
from jointwave.compare.runs.checkpoint.lock import locked
from jointwave.compare.runs.reuse import ResultFolder
from jointwave.compare.studies.sweep import Work, compare_scene
from jointwave.compare.text import percent
from jointwave.results.dataset import energy_residual, open_ledger

WORST = "worst misfit (%)"
WHOLE = 0.9  # of the scene's duration; a curve that covers less is mentioned
HINT = "all misfits, and solutions that do not apply: --all; as JSON: --json"


def compare(asked: Compare) -> None:
    """Compare the solutions of a scene or of every case of a sweep, or print the estimated cost."""
    if asked.swept or asked.members:
        idle = {"--all": asked.every, "--read": asked.reads, "--results": asked.results}
        if given := [option for option, there in idle.items() if there]:
            allowed = "is not of a sweep: --out keeps the tables and results of each point"
            raise SceneError(given[0], "", None, allowed)

        def work_of(scenes: list[AnyScene]) -> Work:
            curves = curves_of(asked.given, scenes, asked.strict, asked.align)
            return partial(compare_scene, spectral=asked.spectral, curves=curves, align=asked.align)

        writes = ("distances", "tables")[: 1 if asked.out is None else 2]
        sweep(asked, asked.out, work_of, applicable, writes)
        return
    scenes = load(asked)
    curves = curves_of(asked.given, scenes, asked.strict, asked.align)
    folder = stored_in(asked, asked.out)
    shows_all = asked.every or asked.as_json or asked.out is not None or bool(curves)
    if asked.dry:
        wanted = applicable if shows_all else deciding
        runs = [run for one in scenes for run in runs_of(wanted(one), one, folder)]
        parts = {"distances": len(scenes) * shows_all, "tables": len(scenes) * bool(asked.out)}
        show_forecasts(runs, asked.as_json, parts)
        return
    found = []
    with nullcontext() if asked.out is None else locked(asked.out):
        for one in scenes:
            with terminal.progress(one.name or one.title) as tell:
                if shows_all:
                    options = tell, asked.align, asked.spectral, folder
                    found.append(comparison.compare(one, curves, *options))
                else:
                    found.append(comparison.solved(one, deciding(one), tell, folder))
        if asked.out is not None:
            tables.write_comparisons(found, asked.out)
    show_comparisons(found, asked.every, asked.as_json, asked.reads)


def show_comparisons(
    found: list[Comparison], every: bool, as_json: bool, reads: bool = False
) -> None:
    """Print the worst variant of each engine.

    every : also print the other variants, all misfits, and why solutions do not apply. reads : also
    print engineering measures of the velocities of all solutions.
    """
    for one in found:
        ledgers = (open_ledger(r) for r in one.results.values() if "energy" in r)
        lines = [*filter(None, ledgers), *chaos(one.results), *unit_doubts(one)]
        terminal.say_warnings(f"{one.scene.name}: {line}".lstrip(": ") for line in lines)
    if as_json:
        terminal.print_json([_facts(one, reads) for one in found])
        return
    _show_verdicts(found, every)
    if every:
        beside = tables.alignment_frame, tables.reason_table
        for table in (tables.distance_table, tables.run_table, *beside):
            terminal.say("")
            terminal.show_frame(table(found))
    if reads:
        readings = tables.reading_frame(found)
        if readings.empty:
            terminal.say("no velocities are recorded: record.velocity or record.points is empty")
        terminal.show_frame(readings)


def _show_verdicts(found: list[Comparison], every: bool) -> None:
    """Print a line for each engine, its reference, and the misfits of external curves."""
    scores, scene, several = engine_scores(found), found[0].scene, len(found) > 1
    count = f"({len(found)} variants, the worst of each engine)" if several else scene.name
    terminal.say(f"{scene.title} {count}".rstrip(), "bold")
    if not scores:
        exact = ", ".join(map(label_of, found[0].results)) or "none"
        terminal.say(f"no engine applies; solutions: {exact}")
        reasons = found[0].reasons
        terminal.show_facts({label_of(name): reasons[name] for name in ENGINES if name in reasons})
    else:
        table = verdict_table(scores).join(tables.run_table(found)["stepping (s)"])
        if not every:
            table = table.loc[table[WORST].fillna(-1.0).groupby("engine", sort=False).idxmax()]
        terminal.show_frame(table if several else table.droplevel("variant"))
        _show_remarks(scores)
    distances = tables.distance_table(found)
    if GIVEN in distances.index.get_level_values(0):
        given = distances.xs(GIVEN).dropna(subset="relative L2 (%)")
        if len(given):
            furthest = given["relative L2 (%)"].groupby(level=["variant", "pair"]).idxmax()
            terminal.show_frame(given.loc[furthest, ["relative L2 (%)", "peak ratio"]])
    if not every and any(beside.shift for one in found for beside in one.besides):
        terminal.show_frame(tables.alignment_frame(found))
    for beside in found[0].besides:
        start, end = beside.time[0], beside.time[-1]
        share, own = (end - start) / scene.time.duration, beside.curves.name
        rows = [one for one in found[0].rows if one.pair.one == own]
        still = dict.fromkeys(one.place.words for one in rows if isnan(one.distance.misfit))
        if share < WHOLE or still:
            line = f"{own}: compared from {start:.4g} to {end:.4g} s only, "
            line += f"{percent(share, 2)} % of the scene"
            terminal.say(line + f"; nothing moves until then: {', '.join(still)}" * bool(still))
    if not every:
        terminal.say(HINT, "dim")


def _show_remarks(scores: dict[str, EngineScore]) -> None:
    """Print the references, differing static states, unchecked variants and exceeded bounds."""
    every = [one for of_all in scores.values() for one in of_all.variants]
    found = (f"{label_of(one.against)} ({one.reason})" for one in every if one.against)
    if reasons := dict.fromkeys(found):
        terminal.say(f"reference: {'; '.join(reasons)}")
    for engine, of_all in scores.items():
        words = max(of_all.variants, key=lambda one: one.static.misfit).static_words
        if words:
            terminal.say(f"static state of {label_of(engine)} {in_words(words)}")
        if len(of_all.variants) > 1 and of_all.unchecked:
            unchecked = ", ".join(of_all.unchecked)
            terminal.say(f"not checked independently: {label_of(engine)} ({unchecked})")
        if of_all.broken:
            terminal.say(f"exceeds the scene's bound: {', '.join(dict.fromkeys(of_all.broken))}")


def _facts(comparison: Comparison, reads: bool) -> dict[str, Any]:
    """Return a variant's misfits, curves and verdicts, machine-readable."""
    scene, results = comparison.scene, comparison.results
    read = {"readings": tables.reading_frame([comparison]).to_dict("records")} if reads else {}
    said = next((result.attrs["warnings"] for result in results.values()), "[]")
    return {
        "title": scene.title,
        "variant": scene.name,
        "warnings": json.loads(said),
        "engines": {
            name: one.facts | {"seconds_stepping": results[name].attrs["seconds_stepping"]}
            for name, one in verdicts(comparison).items()
        },
        "rows": [row.facts for row in comparison.rows],
        "curves": tables.alignment_frame([comparison]).to_dict("records"),
        "energy_residual": {k: energy_residual(r) for k, r in results.items() if "energy" in r},
        "does_not_apply": comparison.reasons,
        **read,
    }


def report(asked: Report) -> None:
    """Write the page and print its summary, or print the estimated cost."""
    scenes, out = asked.scenes or [], asked.out
    for name in scenes:
        load(SceneOptions(scene=name, changes=[], variant=None, strict=asked.strict))
    stored = ResultFolder(results_of(), asked.fresh)
    if asked.dry:
        runs, parts = pages.planned(out, scenes, stored)
        show_forecasts(runs, asked.as_json, parts)
        return
    with locked(out, out / "figures", out / "studies"), terminal.progress("report") as advance:
        found = pages.build(out, advance, scenes=scenes, peers_table=asked.peers, stored=stored)
    page, summary = found.page, found.page["summary"]
    if asked.as_json:
        rows, columns = summary.reset_index().values.tolist(), ["what", "pair", *summary]
        terminal.print_json({"page": str(found.file), "columns": columns, "rows": rows})
        return
    for sentence in page["lead"].values():
        terminal.say(sentence)
    if page["about"]:
        terminal.say(f"\n{page['about'].sentence}")
    terminal.say("\nLargest relative L2 misfit over the variants of each scene:")
    terminal.show_frame(summary)
    if claims := page["claims"]:
        holding = sum(claim.holds for _, claim in claims)
        terminal.say(f"{holding} of {len(claims)} claims of the paper's figures hold.")
    terminal.say(f"report: {found.file}")
