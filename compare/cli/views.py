"""Output of each command: its findings as tables, or the same facts as JSON."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from cases.kinds import AnyScene
from compare.cli.terminal import print_json, say, say_warnings, show_numbers, show_table

if TYPE_CHECKING:
    from compare.report.report import Report
    from compare.runs.run import Done

MOST_PIECES = 8  # in a line


def show_scenes(rows: list[tuple[Path, list[AnyScene]]], as_json: bool) -> None:
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
    else:
        cells = [[f["scene"], f["title"], ", ".join(f["variants"])] for f in facts]
        show_table(["scene", "title", "variants"], cells)


def show_runs(done: list[Done], as_json: bool) -> None:
    """Print what was run, what it cost and where it is."""
    say_warnings(f"{d.job.scene.name}: {d.ledger}".lstrip(": ") for d in done if d.ledger)
    if as_json:
        print_json([_run_facts(d) for d in done])
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
            say(f"{name}: no snapshots: the solution is known at the receivers only")


def _run_facts(done: Done) -> dict[str, Any]:
    return {
        "variant": done.job.scene.name,
        "engine": done.job.name,
        "steps": done.steps,
        "seconds_stepping": done.seconds,
        "energy_residual": done.residual,
        "file": str(done.job.path),
        "fragments": done.fragments,
        "static_out_of_balance": done.out_of_balance,
        "fields": [str(path) for path in done.fields],
    }


def _what_broke(fragments: list[dict[str, Any]]) -> str:
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


def show_report(found: Report, as_json: bool) -> None:
    """Print the report's summary and where the page is."""
    page = found.page
    if as_json:
        summary = page.summary
        rows = [[kind, *row] for kind, rows in summary.groups.items() for row in rows]
        print_json({"page": str(found.file), "columns": ["what", *summary.header], "rows": rows})
        return
    for engine, sentence in page.overview.lead.items():
        say(f"{engine} {sentence}")
    if page.about:
        say(f"\n{page.about.sentence}")
    say("\nLargest relative L2 misfit over the variants of each scene, in %:")
    groups = {
        kind: [[cell.replace("< ", "<") for cell in row] for row in rows]
        for kind, rows in page.summary.groups.items()
    }
    show_numbers(page.summary.header, groups)
    if page.claims:
        holding = page.claims - len(page.failed)
        say(f"{holding} of {page.claims} claims of the paper's figures hold.")
    say(f"report: {found.file}")
