"""What each command shows: its findings as tables, or the same facts as JSON."""

from math import isnan
from pathlib import Path
from typing import Any

from cases.result import energy_residual
from cases.scene import Scene
from compare.terminal import print_json, say, show_numbers, show_table

MOST_PIECES = 8  # in a line


def show_scenes(rows: list[tuple[Path, list[Scene]]], as_json: bool) -> None:
    """Print the shipped scenes."""
    facts: list[dict[str, Any]] = [
        {
            "scene": f"{path.parent.name}/{path.stem}",
            "title": scenes[0].title,
            "variants": [s.name for s in scenes[1:]],
        }
        for path, scenes in rows
    ]
    if as_json:
        print_json(facts)
        return
    cells = [[f["scene"], f["title"], ", ".join(f["variants"])] for f in facts]
    show_table(["scene", "title", "variants"], cells)


def show_runs(done: list[Any], as_json: bool) -> None:
    """Print what was run, what it cost and where it is."""
    facts = [
        {
            "variant": d.job.scene.name,
            "engine": d.job.name,
            "steps": d.steps,
            "seconds_stepping": d.seconds,
            "energy_residual": d.residual,
            "file": str(d.job.path),
            "fragments": d.fragments,
            "static_out_of_balance": d.out_of_balance,
            "fields": [str(path) for path in d.fields],
        }
        for d in done
    ]
    if as_json:
        print_json(facts)
        return
    columns = ["variant", "engine", "steps", "stepping, s", "energy residual", "file"]
    show_table(columns, [_run_cells(d) for d in done])
    for d in done:
        name = d.job.scene.name or d.job.name
        if d.out_of_balance is not None:
            say(f"{name}: starts at rest, out-of-balance force ratio {d.out_of_balance:.1e}")
        if d.fragments is not None:
            say(f"{name}: {_what_broke(d.fragments)}")
        for path in d.fields:
            say(f"{name}: snapshots for ParaView, {path}")
        if d.job.scene.record.fields is not None and not d.fields:
            say(f"{name}: no snapshots, its solution is known at the receivers only")


def _what_broke(fragments: list[dict[str, Any]]) -> str:
    """Return in one line how many joints broke, and the pieces between them."""
    count = len(fragments) - 1
    if not count:
        return "no joint broke"
    broke = f"{count} joint{'s' * (count > 1)} broke; fragments: "
    pieces = [_piece(f) for f in fragments[:MOST_PIECES]]
    left_out = [f"{len(fragments) - MOST_PIECES} more"] if len(fragments) > MOST_PIECES else []
    return broke + ", ".join(pieces + left_out)


def _piece(fragment: dict[str, Any]) -> str:
    v = fragment["velocity"]
    speed = f"{v:.3g}" if isinstance(v, float) else f"({', '.join(f'{x:.3g}' for x in v)})"
    return f"{fragment['from_y']:g} to {fragment['to_y']:g} m at {speed} m/s"


def _run_cells(done: Any) -> list[str]:
    stepped = done.steps > 0
    return [
        done.job.scene.name or "-",
        done.job.name,
        f"{done.steps:,}" if stepped else "-",
        f"{done.seconds:.2g}" if stepped else "-",
        "-" if done.residual is None else f"{done.residual:.1e}",
        str(done.job.path),
    ]


def show_explanation(found: Any, as_json: bool) -> None:
    """Print what a scene calls for, its steps, and what can solve it."""
    if as_json:
        print_json(_explanation_facts(found))
        return
    p = found.properties
    say(f"{found.scene.title} {found.scene.name}", "bold")
    say(
        f"{p.block_count} blocks of {p.spacing:g} m; E_eq {p.modulus:.4g} Pa, Poisson "
        f"{p.poisson:.4g}, bar speed {p.bar_speed:.5g} m/s, K'_n {p.regular_stiffness:.4g} Pa/m"
    )
    effects = [[e.name, "yes" if e.active else "left out", e.reason] for e in found.effects]
    show_table(["effect", "computed", "because"], effects)
    steps = [
        [s.engine, f"{s.critical:.4g}", f"{s.dt:.4g}", f"{s.dt / s.critical:.3g}", f"{s.steps:,}"]
        for s in found.steps
    ]
    show_table(["engine", "critical step, s", "step, s", "fraction", "steps"], steps)
    say(
        f"a step of a rigid block takes {found.cost.own:.2g} ns here, "
        f"{100 * found.cost.share:.2g} % of the {found.cost.everything:.2g} ns with every effect"
    )
    answers = [[k, "yes" if a else "no", a.reason] for k, a in found.answers.items()]
    show_table(["solution", "applies", "why not"], answers)


def _explanation_facts(found: Any) -> dict[str, Any]:
    p = found.properties
    return {
        "title": found.scene.title,
        "variant": found.scene.name,
        "blocks": p.block_count,
        "bar_speed": p.bar_speed,
        "equivalent_modulus": p.modulus,
        "poisson": p.poisson,
        "effects": {e.name: {"active": e.active, "why": e.reason} for e in found.effects},
        "steps": [s.__dict__ for s in found.steps],
        "nanoseconds_per_block_step": found.cost.own,
        "nanoseconds_with_everything": found.cost.everything,
        "solutions": {k: {"applies": a.yes, "why_not": a.reason} for k, a in found.answers.items()},
    }


def show_comparisons(found: list[Any], as_json: bool) -> None:
    """Print the distances of every pair, and why a solution is missing."""
    if as_json:
        print_json([_comparison_facts(c) for c in found])
        return
    for comparison in found:
        scene = comparison.scene
        say(f"\n{scene.title} {scene.name}", "bold")
        groups: dict[str, list[list[str]]] = {}
        for row in comparison.rows:
            groups.setdefault(row.pair.kind, []).append(_distance_cells(row))
        if groups:
            show_numbers(DISTANCE_COLUMNS, groups)
        else:
            say("  nothing to compare: no two solutions of a pair apply")
        for beside in comparison.besides:
            say(f"  {_curve_sentence(beside)}")
        for name, residual in _residuals(comparison).items():
            say(f"  {name}: energy balance open by {residual:.1e} of the work put in")
        for name, reason in comparison.reasons.items():
            say(f"  {name} does not apply: {reason}", "dim")


def _curve_sentence(beside: Any) -> str:
    """Return in one line how a file's curves were put beside the solutions."""
    shift, time = beside.shift, beside.time
    whose = "its own" if beside.own_times else "the scene's"
    start, end = (round(1e3 * t, 6) + 0.0 for t in (time[0], time[-1]))
    parts = [f"at {len(time)} of {whose} times, {start:.6g} to {end:.6g} ms"]
    parts += [f"{beside.outside:.1%} of its duration lies outside"]
    parts += [f"straight lines between them miss {beside.missed:.2%} of the finer waveform"]
    if shift is not None:
        parts += [
            f"clock moved by {1e3 * shift.seconds:+.4f} ms onto {shift.onto}, "
            f"correlation {shift.correlation:.4f}"
            if shift.onto
            else "clock not moved: no wave to correlate with"
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


def _distance_cells(row: Any) -> list[str]:
    d = row.distance
    return [
        f"{row.pair.one} ~ {row.pair.other}",
        f"{row.quantity} {row.y:g} m",
        _number(d.misfit, ".3%"),
        _number(d.peak_ratio, ".4f"),
        _number(1e3 * d.delay, "+.3f"),
        _number(d.period_ratio, ".4f"),
        _number(d.envelope, ".2%"),
        _number(d.phase, ".2%"),
    ]


def _number(x: float | None, form: str) -> str:
    return "-" if x is None or isnan(x) else format(x, form)


def _comparison_facts(comparison: Any) -> dict[str, Any]:
    return {
        "title": comparison.scene.title,
        "variant": comparison.scene.name,
        "rows": [
            {**r.pair._asdict(), "quantity": r.quantity, "y": r.y, **r.distance._asdict()}
            for r in comparison.rows
        ],
        "curves": [_curve_facts(beside) for beside in comparison.besides],
        "energy_residual": _residuals(comparison),
        "does_not_apply": comparison.reasons,
    }


def _residuals(comparison: Any) -> dict[str, float]:
    results = comparison.results.items()
    return {name: energy_residual(r) for name, r in results if "energy" in r}


def show_report(found: Any, as_json: bool) -> None:
    """Print the report's summary and where the page is."""
    if as_json:
        print_json({"page": str(found.page), "columns": found.columns, "rows": found.rows})
        return
    for engine, sentence in found.overview.lead:
        say(f"{engine} {sentence}")
    if found.about:
        say(f"\n{found.about.sentence}")
    say("\nLargest relative L2 misfit over the variants of each scene, in %:")
    groups = {
        kind: [[cell.replace("< ", "<") for cell in row] for row in rows]
        for kind, rows in found.summary.groups.items()
    }
    show_numbers(found.summary.header, groups)
    findings = [finding for group in found.findings.values() for finding in group]
    if findings:
        holding = sum(finding.holds for finding in findings)
        say(f"{holding} of {len(findings)} claims that the paper's figures make hold.")
    say(f"report: {found.page}")
