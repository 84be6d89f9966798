"""Output of `jointwave compare`: the verdict on each engine, every distance on request, or JSON."""

import json
from typing import Any

from jointwave.compare.cli.terminal import print_json, say, say_warnings, show_facts, show_frame
from jointwave.compare.engines import ENGINES, in_words, label_of
from jointwave.compare.figures.tables import alignment_frame, reading_frame
from jointwave.compare.misfit.pairs import GIVEN, Comparison
from jointwave.compare.report.tables import distance_table, reason_table, run_table, verdict_table
from jointwave.compare.report.verdict import EngineScore, engine_scores, score
from jointwave.results.dataset import energy_residual, open_ledger

WORST = "worst misfit (%)"
HINT = "all misfits, and solutions that do not apply: --all; as JSON: --json"


def show_comparisons(
    found: list[Comparison], every: bool, as_json: bool, reads: bool = False
) -> None:
    """Print the worst variant of each engine; every : also all others, all misfits, and why
    solutions do not apply.

    reads : also what engineers read off the velocities of all solutions.
    """
    for one in found:
        ledgers = (open_ledger(r) for r in one.results.values() if "energy" in r)
        say_warnings(f"{one.scene.name}: {line}".lstrip(": ") for line in ledgers if line)
    if as_json:
        print_json([_facts(one, reads) for one in found])
        return
    _show_verdicts(found, every)
    if every:
        for table in (distance_table, run_table, alignment_frame, reason_table):
            say("")
            show_frame(table(found))
    if reads:
        readings = reading_frame(found)
        if readings.empty:
            say("no velocities are recorded: record.velocity or record.points is empty")
        show_frame(readings)


def _show_verdicts(found: list[Comparison], every: bool) -> None:
    """Print a line for each engine, what it is compared with, and the curves of others."""
    scores, scene, several = engine_scores(found), found[0].scene, len(found) > 1
    count = f"({len(found)} variants, the worst of each engine)" if several else scene.name
    say(f"{scene.title} {count}".rstrip(), "bold")
    if not scores:
        exact = ", ".join(map(label_of, found[0].results)) or "none"
        say(f"no engine applies; solutions: {exact}")
        reasons = found[0].reasons
        show_facts({label_of(name): reasons[name] for name in ENGINES if name in reasons})
    else:
        table = verdict_table(scores).join(run_table(found)["stepping (s)"])
        if not every:
            table = table.loc[table[WORST].fillna(-1.0).groupby("engine", sort=False).idxmax()]
        show_frame(table if several else table.droplevel("variant"))
        _show_remarks(scores)
    distances = distance_table(found)
    if GIVEN in distances.index.get_level_values(0):
        given = distances.xs(GIVEN)
        furthest = given["relative L2 (%)"].groupby(level=["variant", "pair"]).idxmax()
        show_frame(given.loc[furthest, ["relative L2 (%)", "peak ratio"]])
    if not every:
        say(HINT, "dim")


def _show_remarks(scores: dict[str, EngineScore]) -> None:
    """Print the references, static states that differ, and variants that are not checked or exceed
    their bounds."""
    variants = [one for of_all in scores.values() for one in of_all.variants]
    reasons = dict.fromkeys(
        f"{label_of(one.against)} ({one.reason})" for one in variants if one.against
    )
    if reasons:
        say(f"reference: {'; '.join(reasons)}")
    for engine, of_all in scores.items():
        words = max(of_all.variants, key=lambda one: one.static.misfit).static_words
        if words:
            say(f"static state of {label_of(engine)} {in_words(words)}")
        if len(of_all.variants) > 1 and of_all.unchecked:
            say(f"not checked independently: {label_of(engine)} ({', '.join(of_all.unchecked)})")
        if of_all.broken:
            say(f"exceeds the scene's bound: {', '.join(dict.fromkeys(of_all.broken))}")


def _facts(comparison: Comparison, reads: bool) -> dict[str, Any]:
    """Return a variant's distances, curves and verdicts, machine-readable."""
    scene, results = comparison.scene, comparison.results
    read = {"readings": reading_frame([comparison]).to_dict("records")} if reads else {}
    said = next((result.attrs["warnings"] for result in results.values()), "[]")
    scores = {name: score(name, comparison) for name in ENGINES if name in results}
    return {
        "title": scene.title,
        "variant": scene.name,
        "warnings": json.loads(said),
        "engines": {
            name: one.facts
            | {"seconds_stepping": results[name].attrs["seconds_stepping"]}
            | {"out_of_bounds": list(one.broken)}
            for name, one in scores.items()
        },
        "rows": [row.facts for row in comparison.rows],
        "curves": alignment_frame([comparison]).to_dict("records"),
        "energy_residual": {k: energy_residual(r) for k, r in results.items() if "energy" in r},
        "does_not_apply": comparison.reasons,
        **read,
    }
