"""What the terminal shows: progress, tables, or the same as JSON."""

import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from math import isnan
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table

from cases.result import energy_residual
from cases.scene import Scene


@contextmanager
def progress(label: str) -> Iterator[Callable[[float], None]]:
    """Show a bar on standard error while something runs, and clear it at the end."""
    columns = TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn()
    console = Console(stderr=True)
    with Progress(
        *columns, console=console, transient=True, disable=not console.is_terminal
    ) as bar:
        task = bar.add_task(label, total=1.0)
        yield lambda fraction: bar.update(task, completed=fraction)


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
    cells = [[f["scene"], f["title"], ", ".join(f["variants"])] for f in facts]
    _show(["scene", "title", "variants"], cells, facts, as_json)


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
        }
        for d in done
    ]
    columns = ["variant", "engine", "steps", "stepping, s", "energy residual", "file"]
    _show(columns, [_run_cells(d) for d in done], facts, as_json)


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
        _print_json(_explanation_facts(found))
        return
    p, console = found.properties, _console()
    console.print(f"{found.scene.title} {found.scene.name}", style="bold")
    console.print(
        f"{p.block_count} blocks of {p.spacing:g} m; E_eq {p.modulus:.4g} Pa, Poisson "
        f"{p.poisson:.4g}, bar speed {p.bar_speed:.5g} m/s, K'_n {p.regular_stiffness:.4g} Pa/m"
    )
    effects = [[e.name, "yes" if e.active else "left out", e.reason] for e in found.effects]
    console.print(_table(["effect", "computed", "because"], effects))
    steps = [
        [s.engine, f"{s.critical:.4g}", f"{s.dt:.4g}", f"{s.dt / s.critical:.3g}", f"{s.steps:,}"]
        for s in found.steps
    ]
    console.print(_table(["engine", "critical step, s", "step, s", "fraction", "steps"], steps))
    answers = [[k, "yes" if a else "no", a.reason] for k, a in found.answers.items()]
    console.print(_table(["solution", "applies", "why not"], answers))


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
        "solutions": {k: {"applies": a.yes, "why_not": a.reason} for k, a in found.answers.items()},
    }


def show_comparisons(found: list[Any], as_json: bool) -> None:
    """Print the distances of every pair, and why a solution is missing."""
    if as_json:
        _print_json([_comparison_facts(c) for c in found])
        return
    console = _console()
    for comparison in found:
        scene = comparison.scene
        console.print(f"\n{scene.title} {scene.name}", style="bold")
        console.print(_table(DISTANCE_COLUMNS, [_distance_cells(r) for r in comparison.rows]))
        for name, residual in _residuals(comparison).items():
            console.print(f"  {name}: energy balance open by {residual:.1e} of the work put in")
        for name, reason in comparison.reasons.items():
            console.print(f"  {name} does not apply: {reason}", style="dim")


DISTANCE_COLUMNS = [
    "what",
    "result",
    "held against",
    "at",
    "misfit",
    "peak ratio",
    "delay, ms",
    "period ratio",
    "envelope",
    "phase",
]


def _distance_cells(row: Any) -> list[str]:
    d = row.distance
    return [
        row.pair.kind,
        row.pair.one,
        row.pair.other,
        f"{row.quantity} {row.y:g} m",
        f"{d.misfit:.3%}",
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
        "energy_residual": _residuals(comparison),
        "does_not_apply": comparison.reasons,
    }


def _residuals(comparison: Any) -> dict[str, float]:
    results = comparison.results.items()
    return {name: energy_residual(r) for name, r in results if "energy" in r}


def show_report(summary: Any, page: Path, as_json: bool) -> None:
    """Print the report's summary and where the page is."""
    if as_json:
        _print_json({"page": str(page), "columns": summary.columns, "rows": summary.rows})
        return
    console = _console()
    console.print(_table(summary.columns, summary.rows))
    console.print(f"report: {page}")


def _show(columns: list[str], rows: list[list[str]], facts: Any, as_json: bool) -> None:
    if as_json:
        _print_json(facts)
    else:
        _console().print(_table(columns, rows))


def _table(columns: list[str], rows: list[list[str]]) -> Table:
    table = Table(box=None, pad_edge=False)
    for column in columns:
        table.add_column(column, overflow="fold")
    for row in rows:
        table.add_row(*row)
    return table


def _console() -> Console:
    # A pipe has no width to respect: a machine or a log gets whole lines.
    console = Console(markup=False, highlight=False)
    return console if console.is_terminal else Console(width=220, markup=False, highlight=False)


def _print_json(value: Any) -> None:
    # JSON has no nan and no infinity; null says as much.
    print(json.dumps(json.loads(json.dumps(value), parse_constant=lambda _: None), indent=2))
