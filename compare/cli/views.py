"""Output of `list`, `run` and `report`: tables, or the same facts as JSON."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from jointwave.cases.scene_type import AnyScene
from jointwave.compare.cli.terminal import print_json, say, say_warnings, show_numbers, show_table

if TYPE_CHECKING:  # each of them imports what its command runs
    from jointwave.compare.report.report import Report
    from jointwave.compare.runs.run import Done

MOST_PIECES = 8  # in a line


def show_scenes(rows: list[tuple[Path, list[AnyScene]]], as_json: bool) -> None:
    """Print the shipped scenes."""
    facts: list[dict[str, Any]] = [
        {"scene": f"{path.parent.name}/{path.stem}", "title": scenes[0].title}
        | {"variants": [s.name for s in scenes[1:]]}
        for path, scenes in rows
    ]
    if as_json:
        print_json(facts)
    else:
        cells = [[f["scene"], f["title"], ", ".join(f["variants"])] for f in facts]
        show_table(["scene", "title", "variants"], cells)


def show_runs(done: "Sequence[Done]", as_json: bool) -> None:
    """Print what was run, what it cost and where it is."""
    say_warnings(f"{d.job.scene.name}: {d.ledger}".lstrip(": ") for d in done if d.ledger)
    facts = [_run_facts(one) for one in done]
    if as_json:
        print_json(facts)
        return
    columns = ["variant", "engine", "steps", "stepping, s", "energy residual", "file"]
    show_table(columns, [_run_cells(one) for one in facts])
    for one in done:
        name, still, pieces = one.job.scene.name or one.job.name, one.out_of_balance, one.fragments
        if still is not None:
            say(f"{name}: starts at rest, out-of-balance force ratio {still:.1e}")
        if pieces is not None:
            say(f"{name}: {_fragments(pieces)}")
        for path in one.fields:
            say(f"{name}: snapshots for ParaView, {path}")
        if one.job.scene.record.fields is not None and not one.fields:
            say(f"{name}: no snapshots: the solution is known at the receivers only")


def _run_facts(done: "Done") -> dict[str, Any]:
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


def _run_cells(one: dict[str, Any]) -> list[str]:
    steps, seconds, residual = one["steps"], one["seconds_stepping"], one["energy_residual"]
    cost = [f"{steps:,}", f"{seconds:.2g}"] if steps else ["-", "-"]
    left = "-" if residual is None else f"{residual:.1e}"
    return [one["variant"] or "-", one["engine"], *cost, left, one["file"]]


def _fragments(fragments: list[dict[str, Any]]) -> str:
    """Return how many joints broke, and where the pieces are and how they move."""
    count, pieces = len(fragments) - 1, []
    for one in fragments[:MOST_PIECES]:
        v = one["velocity"]
        speed = f"{v:.3g}" if isinstance(v, float) else f"({', '.join(f'{x:.3g}' for x in v)})"
        pieces.append(f"{one['from_y']:g} to {one['to_y']:g} m at {speed} m/s")
    if len(fragments) > MOST_PIECES:
        pieces.append(f"{len(fragments) - MOST_PIECES} more")
    broke = f"{count} joint{'s' * (count > 1)} broke; fragments: {', '.join(pieces)}"
    return broke if count else "no joint broke"


def show_report(found: "Report", as_json: bool) -> None:
    """Print the report's summary and where the page is."""
    page = found.page
    if as_json:
        summary = found.summary.reset_index()
        columns, rows = ["what", *summary.columns[1:]], summary.values.tolist()
        print_json({"page": str(found.file), "columns": columns, "rows": rows})
        return
    for engine, sentence in page["overview"]["lead"].items():
        say(f"{engine} {sentence}")
    if page["about"]:
        say(f"\n{page['about'].sentence}")
    say("\nLargest relative L2 misfit over the variants of each scene, in %:")
    groups = {
        kind: rows.droplevel(0).reset_index().values.tolist()
        for kind, rows in found.summary.groupby(level=0, sort=False)
    }
    show_numbers(["pair", *found.summary.columns], groups)
    if claims := page["claims"]:
        holding = sum(claim.holds for _, claim in claims)
        say(f"{holding} of {len(claims)} claims of the paper's figures hold.")
    say(f"report: {found.file}")
