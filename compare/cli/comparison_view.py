"""Output of `jointwave compare`: a few lines, every distance on request, or JSON."""

import json
from collections.abc import Iterator
from math import isnan
from typing import Any

from compare.cli.terminal import print_json, say, say_warnings, show_numbers, show_table
from compare.engines import ENGINES
from compare.misfit.differences import STRESS, VELOCITY, PeakDifference
from compare.misfit.metrics import Worst
from compare.misfit.pairs import GIVEN, Comparison, Row
from compare.report.verdict import Standing, held_to, standings
from compare.solvers.incident import side_error
from compare.solvers.record import Kind
from compare.text import cell, in_seconds, mean_and_worst, percent
from results.dataset import energy_residual, open_ledger

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
    say_warnings(line for comparison in found for line in _open_ledgers(comparison))
    if as_json:
        read = [_readings(c) for c in found] if reads else [{}] * len(found)
        print_json([_comparison_facts(c) | more for c, more in zip(found, read, strict=True)])
        return
    _show_answer(found, every)
    if every:
        for comparison in found:
            _show_distances(comparison)
    if reads:
        _show_readings(found)


def _show_answer(found: list[Comparison], every: bool) -> None:
    """Print at most ten lines: the engines by their worst variant, and what was given."""
    stand = standings(found)
    several = len(found) > 1
    count = f" ({len(found)} variants, the worst of each engine)" if several else ""
    say(f"{found[0].scene.title}{count or f' {found[0].scene.name}'}".rstrip(), "bold")
    if stand:
        show_table(ANSWER, [_engine_cells(e, one, found, several) for e, one in stand.items()])
    below = [*_remarks(stand, several), *([] if stand else _without_engine(found[0]))]
    hint = "" if every else HINT
    room = MOST_LINES - 2 - len(stand) - len(below) - bool(hint)
    files = [*_files(found)]
    if len(files) > room:
        files = [*files[: room - 1], f"{len(files) - room + 1} more curves"]
    for line in [*below, *files, *([hint] if hint else [])]:
        say(line, "dim" if line == hint else "")


def _readings(comparison: Comparison) -> dict[str, Any]:
    from compare.figures.tables import reading_frame

    return {"readings": reading_frame([comparison]).to_dict("records")}


def _show_readings(found: list[Comparison]) -> None:
    from compare.figures.tables import reading_frame

    read = reading_frame(found)
    say("")
    if len(read):
        variants = read.set_index("variant").map(cell).groupby(level=0, sort=False)
        groups = {str(name): rows.values.tolist() for name, rows in variants}
        show_numbers([*read.columns[1:]], groups)
    else:
        say("no velocities are recorded: record.velocity or record.points is empty")


def _engine_cells(engine: str, one: Standing, found: list[Comparison], several: bool) -> list[str]:
    """Return an engine's line: that of its worst variant, and the most that any of them took."""
    ran = [c.results[engine].attrs for c in found if engine in c.results]
    total = max(one.variants, key=lambda held: _rank(held.total))
    own = max((held.own for held in one.variants), key=_rank)
    where = f"{total.total.where}, {total.variant}" if several else total.total.where
    return [
        engine,
        in_percent(total.total),
        where if total.total.place else "-",
        *(_peak(total.peaks.get(name)) for name in (VELOCITY, STRESS)),
        total.against or "-",
        in_percent(own),
        in_seconds(max(about["seconds_stepping"] for about in ran)),
        f"{one.verdict.sign} {one.verdict.word}",
    ]


def _peak(peak: PeakDifference | None) -> str:
    return f"{mean_and_worst(peak)} %" if peak else "-"


def _rank(worst: Worst) -> float:
    return -1.0 if isnan(worst.judged) else worst.judged


def in_percent(worst: Worst) -> str:
    """Return a misfit in percent: below ten times the reference's own error only that it is."""
    if isnan(worst.judged):
        return "-"
    below = "< " if worst.misfit < worst.judged else ""
    return f"{below}{percent(worst.judged).removeprefix('< ' if below else '')} %"


def _remarks(stand: dict[str, Standing], several: bool) -> Iterator[str]:
    """Yield the references, engines not checked independently, and bounds that are exceeded."""
    held = [one for standing in stand.values() for one in standing.variants]
    reasons = dict.fromkeys(f"{one.against}: {one.reason}" for one in held if one.against)
    own = Kind.NUMERICAL.words
    others = [engine for engine, one in stand.items() if {*one.meanings} - {own}]
    said = [f"a modelling difference of {', '.join(others)}"] if others else []
    said += [
        f"static state of {e} {one.static_words}" for e, one in stand.items() if one.static_words
    ]
    if reasons:
        yield f"reference: {'; '.join([*reasons, *said])}"
    alone = {engine: one.unchecked for engine, one in stand.items() if one.unchecked}
    if alone and several:
        named = (f"{engine} ({', '.join(variants)})" for engine, variants in alone.items())
        yield f"not checked independently: {'; '.join(named)}"
    broken = dict.fromkeys(pair for one in stand.values() for pair in one.broken)
    if broken:
        yield f"exceeds the scene's bound: {', '.join(broken)}"


def _without_engine(comparison: Comparison) -> Iterator[str]:
    """Yield what solves a scene that no engine does, and why they do not."""
    yield f"no engine applies; exact solutions: {', '.join(comparison.results) or 'none'}"
    yield from (f"{name}: {why}" for name, why in comparison.reasons.items() if name in ENGINES)


def _files(found: list[Comparison]) -> Iterator[str]:
    """Yield a line for each external file in each variant: its worst misfit from each engine."""
    for comparison in found:
        rows = [row for row in comparison.rows if row.pair.kind == GIVEN]
        name = f"{comparison.scene.name}: " if len(found) > 1 and comparison.scene.name else ""
        for beside in comparison.besides:
            mine = [row for row in rows if row.pair.one == beside.curves.name]
            by_engine = {e: [row for row in mine if row.pair.other == e] for e in ENGINES}
            parts = [
                _file_part(max(there, key=lambda row: row.distance.misfit))
                for there in by_engine.values()
                if there
            ]
            clock = f", clock {1e3 * beside.shift.seconds:+.4g} ms" if beside.shift else ""
            where = "; ".join(parts) or "no engine records a waveform there"
            yield f"{name}{beside.curves.name}{clock}: {where}"


def _file_part(row: Row) -> str:
    """Return how far a curve is from one engine; its peak over the engine's, data over model."""
    far, peak = percent(row.distance.misfit), _number(row.distance.peak_ratio, ".3f")
    return f"{far} % from {row.pair.other} ({row.place.words}, data/model {peak})"


def _show_distances(comparison: Comparison) -> None:
    """Print every distance of one variant, its ledgers, and what does not apply."""
    scene, near = comparison.scene, _near_sides(comparison)
    say(f"\n{scene.title} {scene.name}".rstrip(), "bold")
    groups: dict[str, list[list[str]]] = {}
    for row in comparison.rows:
        heading = f"{GIVEN}, data over model" if row.pair.kind == GIVEN else row.pair.kind
        groups.setdefault(heading, []).append(_distance_cells(row, near))
    if groups:
        show_numbers(DISTANCE_COLUMNS, groups)
    else:
        say("  nothing to compare: no pair of solutions applies")
    for beside in comparison.besides:
        say(f"  {_curve_sentence(beside)}")
    for name, residual in _residuals(comparison).items():
        say(f"  {name}: energy residual {residual:.1e} of the work done by the load")
    for name, reason in comparison.reasons.items():
        say(f"  {name} does not apply: {reason}", "dim")


def _near_sides(comparison: Comparison) -> set[tuple[str, tuple[float, ...]]]:
    """Return the key of [record] and the place of receivers that feel an error of quiet sides."""
    found = side_error(comparison.scene)
    return {(key, at) for key, places in (found.near if found else {}).items() for at in places}


def _curve_sentence(beside: Any) -> str:
    """Return in one line how a file's curves were put beside the solutions."""
    shift, time = beside.shift, beside.time
    whose = "its own" if beside.own_times else "the scene's"
    start, end = (round(1e3 * t, 6) + 0.0 for t in (time[0], time[-1]))
    parts = [f"at {len(time)} of {whose} times, {start:.6g} to {end:.6g} ms"]
    parts += [f"{beside.outside:.1%} of its duration outside the scene's"]
    parts += [f"linear interpolation loses {beside.missed:.2%} of the finer waveform"]
    if shift is not None:
        parts += [
            f"shifted by {1e3 * shift.seconds:+.4f} ms to align with {shift.onto}, "
            f"correlation {shift.correlation:.4f}"
            if shift.onto
            else "not shifted: no wave to correlate with"
        ]
    if beside.left_out:
        parts += [f"not in this scene: {', '.join(map(str, beside.left_out))}"]
    return f"{beside.curves.name}: {'; '.join(parts)}"


def _curve_facts(beside: Any) -> dict[str, Any]:
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
        "shift": beside.shift.__dict__ if beside.shift else None,
    }


DISTANCE_COLUMNS = ["pair", "at", "misfit", "peak", "delay, ms", "period", "envelope", "phase"]


def _distance_cells(row: Row, near: set[tuple[str, tuple[float, ...]]]) -> list[str]:
    d = row.distance
    beside = " (near a quiet side)" if (row.place.key, row.place.at) in near else ""
    return [
        f"{row.pair.one} ~ {row.pair.other}",
        f"{row.place.named} {row.place.receiver}{beside}",
        _number(d.misfit, ".3%"),
        _number(d.peak_ratio, ".4f"),
        _number(1e3 * d.delay, "+.3f"),
        _number(d.period_ratio, ".4f"),
        _number(d.envelope, ".2%"),
        _number(d.phase, ".2%"),
    ]


def _number(x: float | None, form: str) -> str:
    return "-" if x is None or isnan(x) else format(x, form)


def _comparison_facts(comparison: Comparison) -> dict[str, Any]:
    engines = [name for name in ENGINES if name in comparison.results]
    results, near = list(comparison.results.values()), _near_sides(comparison)
    return {
        "title": comparison.scene.title,
        "variant": comparison.scene.name,
        "warnings": json.loads(results[0].attrs["warnings"]) if results else [],
        "engines": {name: _engine_facts(name, comparison) for name in engines},
        "rows": [
            r.facts
            | {"floor": r.floor, "faint": r.faint, "of_all": r.of_all}
            | {"near_side": (r.place.key, r.place.at) in near}
            for r in comparison.rows
        ],
        "curves": [_curve_facts(beside) for beside in comparison.besides],
        "energy_residual": _residuals(comparison),
        "does_not_apply": comparison.reasons,
    }


def _engine_facts(engine: str, comparison: Comparison) -> dict[str, Any]:
    """Return an engine's line for one variant; floor : of its reference's own error."""
    held, about = held_to(engine, comparison), comparison.results[engine].attrs
    return held.facts | {
        "seconds_stepping": about["seconds_stepping"],
        "out_of_bounds": list(held.broken),
    }


def _open_ledgers(comparison: Comparison) -> Iterator[str]:
    for result in comparison.results.values():
        if "energy" in result and (line := open_ledger(result)):
            yield f"{comparison.scene.name}: {line}".lstrip(": ")


def _residuals(comparison: Comparison) -> dict[str, float]:
    results = comparison.results.items()
    return {name: energy_residual(r) for name, r in results if "energy" in r}
