"""Output of `jointwave compare`: a few lines, every distance on request, or JSON."""

import json
from collections.abc import Iterator
from math import isnan
from typing import Any

from jointwave.compare.cli.frames import show_frame
from jointwave.compare.cli.terminal import print_json, say, say_warnings, show_table
from jointwave.compare.engines import ENGINES
from jointwave.compare.figures.tables import alignment_frame, reading_frame
from jointwave.compare.misfit.alignment import AlignedCurve
from jointwave.compare.misfit.differences import STRESS, VELOCITY
from jointwave.compare.misfit.metrics import Worst
from jointwave.compare.misfit.pairs import GIVEN, Comparison
from jointwave.compare.misfit.places import Place
from jointwave.compare.report.tables import distance_table, reason_table, run_table
from jointwave.compare.report.verdict import EngineScore, engine_scores, score
from jointwave.compare.solvers.incident import side_error
from jointwave.compare.solvers.record import Kind
from jointwave.compare.text import in_seconds, mean_and_worst, percent
from jointwave.results.dataset import energy_residual, open_ledger

MOST_LINES = 10  # of the answer
HINT = "all misfits, and solutions that do not apply: --all; as JSON: --json"
ANSWER = ["engine", "worst misfit", "at", "PPV", "peak stress", "compared with", "own error"]
ANSWER += ["stepping", "verdict"]


def show_comparisons(
    found: list[Comparison], every: bool, as_json: bool, reads: bool = False
) -> None:
    """Print one line for each engine; every : also all misfits, and why solutions do not apply.

    reads : also what engineers read off the velocities of all solutions.
    """
    for one in found:
        ledgers = (open_ledger(r) for r in one.results.values() if "energy" in r)
        say_warnings(f"{one.scene.name}: {line}".lstrip(": ") for line in ledgers if line)
    if as_json:
        print_json([_facts(one, reads) for one in found])
        return
    _show_answer(found, every)
    if every:
        _show_all(found)
    if reads:
        say("")
        read = reading_frame(found)
        if read.empty:
            say("no velocities are recorded: record.velocity or record.points is empty")
        else:
            show_frame(read.set_index(["variant", "solution", "at"]))


def _show_answer(found: list[Comparison], every: bool) -> None:
    """Print at most ten lines: the engines by their worst variant, and what was given."""
    stand, scene, several = engine_scores(found), found[0].scene, len(found) > 1
    count = f"({len(found)} variants, the worst of each engine)" if several else scene.name
    say(f"{scene.title} {count}".rstrip(), "bold")
    if stand:
        show_table(ANSWER, [_engine_cells(e, one, found) for e, one in stand.items()])
    below = [*_remarks(stand, several)] if stand else [*_without_engine(found[0])]
    files = [*_files(found)]
    room = MOST_LINES - 2 - len(stand) - len(below) - (not every)
    if len(files) > room:
        files = [*files[: room - 1], f"{len(files) - room + 1} more curves"]
    for line in [*below, *files]:
        say(line)
    if not every:
        say(HINT, "dim")


def _engine_cells(engine: str, one: EngineScore, found: list[Comparison]) -> list[str]:
    """Return an engine's line: that of its worst variant, and the most that any of them took."""
    worst = max(one.variants, key=lambda held: _rank(held.total))
    own = max((held.own for held in one.variants), key=_rank)
    ran = [c.results[engine].attrs["seconds_stepping"] for c in found if engine in c.results]
    where = f"{worst.total.where}, {worst.variant}" if len(found) > 1 else worst.total.where
    peaks = [worst.peaks.get(name) for name in (VELOCITY, STRESS)]
    return [
        engine,
        in_percent(worst.total),
        where if worst.total.place else "-",
        *(f"{mean_and_worst(peak)} %" if peak else "-" for peak in peaks),
        worst.against or "-",
        in_percent(own),
        in_seconds(max(ran)),
        f"{one.verdict.sign} {one.verdict.word}",
    ]


def _rank(worst: Worst) -> float:
    return -1.0 if isnan(worst.judged) else worst.judged


def in_percent(worst: Worst) -> str:
    """Return a misfit in percent: below ten times the reference's own error only that it is."""
    if isnan(worst.judged):
        return "-"
    below = "< " if worst.misfit < worst.judged else ""
    return f"{below}{percent(worst.judged).removeprefix('< ' if below else '')} %"


def _remarks(stand: dict[str, EngineScore], several: bool) -> Iterator[str]:
    """Yield the references, engines not checked independently, and bounds that are exceeded."""
    held = [one for of_all in stand.values() for one in of_all.variants]
    said = list(dict.fromkeys(f"{one.against}: {one.reason}" for one in held if one.against))
    own = {"", Kind.NUMERICAL.words}
    others = [e for e, of in stand.items() if {one.meaning for one in of.variants} - own]
    if said:
        said += [f"a modelling difference of {', '.join(others)}"] if others else []
        for engine, of_all in stand.items():
            words = max(of_all.variants, key=lambda one: one.static.misfit).static_words
            said += [f"static state of {engine} {words}"] if words else []
        yield f"reference: {'; '.join(said)}"
    alone = [f"{e} ({', '.join(one.unchecked)})" for e, one in stand.items() if one.unchecked]
    if alone and several:
        yield f"not checked independently: {'; '.join(alone)}"
    broken = dict.fromkeys(pair for one in stand.values() for pair in one.broken)
    if broken:
        yield f"exceeds the scene's bound: {', '.join(broken)}"


def _without_engine(comparison: Comparison) -> Iterator[str]:
    """Yield what solves a scene that no engine does, and why they do not."""
    yield f"no engine applies; exact solutions: {', '.join(comparison.results) or 'none'}"
    yield from (f"{name}: {why}" for name, why in comparison.reasons.items() if name in ENGINES)


def _files(found: list[Comparison]) -> Iterator[str]:
    """Yield a line for each external file in each variant: its worst misfit from each engine, and
    its peak over the engine's, data over model."""
    for comparison in found:
        variant = f"{comparison.scene.name}: " if len(found) > 1 and comparison.scene.name else ""
        for beside in comparison.besides:
            name, parts = beside.curves.name, []
            for engine in ENGINES:
                rows = [r for r in comparison.rows if r.pair == (name, engine, GIVEN)]
                if rows:
                    row = max(rows, key=lambda row: row.distance.misfit)
                    far, peak = percent(row.distance.misfit), row.distance.peak_ratio
                    ratio = f"data/model {'-' if isnan(peak) else format(peak, '.3f')}"
                    parts.append(f"{far} % from {engine} ({row.place.words}, {ratio})")
            clock = f", clock {1e3 * beside.shift.seconds:+.4g} ms" if beside.shift else ""
            where = "; ".join(parts) or "no engine records a waveform there"
            yield f"{variant}{name}{clock}: {where}"


def _show_all(found: list[Comparison]) -> None:
    """Print every distance, how curves were aligned, the runs, and what does not apply."""
    curves = alignment_frame(found)
    if not curves.empty:
        curves = curves.set_index(["file", "variant"])
    for table in (distance_table(found), curves, run_table(found)):
        if not table.empty:
            say("")
            show_frame(table)
    for one in found:
        name = f"{one.scene.name}: " if one.scene.name and len(found) > 1 else ""
        near = [Place(key, "", at).receiver for key, at in _near_sides(one)]
        if near:
            say(f"{name}near a quiet side: {', '.join(near)}")
    for reason in reason_table(found).itertuples(index=False):
        whose = "" if reason[1] == "all" else f" ({reason[1]})"
        say(f"{reason[0]} does not apply{whose}: {reason[2]}", "dim")


def _near_sides(comparison: Comparison) -> list[tuple[str, tuple[float, ...]]]:
    """Return key of [record] and place of the receivers that feel an error of quiet sides."""
    found = side_error(comparison.scene)
    return [(key, at) for key, places in (found.near if found else {}).items() for at in places]


def _residuals(comparison: Comparison) -> dict[str, float]:
    results = comparison.results.items()
    return {name: energy_residual(r) for name, r in results if "energy" in r}


def _facts(comparison: Comparison, reads: bool) -> dict[str, Any]:
    """Return a variant's distances, curves and verdicts, machine-readable."""
    scene, results, near = comparison.scene, comparison.results, _near_sides(comparison)
    read = {"readings": reading_frame([comparison]).to_dict("records")} if reads else {}
    said = next((result.attrs["warnings"] for result in results.values()), "[]")
    return {
        "title": scene.title,
        "variant": scene.name,
        "warnings": json.loads(said),
        "engines": {name: _engine_facts(name, comparison) for name in ENGINES if name in results},
        "rows": [
            r.facts
            | {"floor": r.floor, "faint": r.faint, "of_all": r.of_all}
            | {"near_side": (r.place.key, r.place.at) in near}
            for r in comparison.rows
        ],
        "curves": [_curve_facts(beside) for beside in comparison.besides],
        "energy_residual": _residuals(comparison),
        "does_not_apply": comparison.reasons,
        **read,
    }


def _engine_facts(engine: str, comparison: Comparison) -> dict[str, Any]:
    held, about = score(engine, comparison), comparison.results[engine].attrs
    bounds = {"seconds_stepping": about["seconds_stepping"], "out_of_bounds": list(held.broken)}
    return held.facts | bounds


def _curve_facts(beside: AlignedCurve) -> dict[str, Any]:
    return {
        "name": beside.curves.name,
        "file": beside.curves.file,
        "places": [str(place) for place in beside.curves.waveforms],
        "left_out": [str(place) for place in beside.left_out],
        "samples": len(beside.time),
        "own_times": beside.own_times,
        "start": float(beside.time[0]),
        "end": float(beside.time[-1]),
        "outside": float(beside.outside),
        "missed": float(beside.missed),
        "shift": vars(beside.shift) if beside.shift else None,
    }
