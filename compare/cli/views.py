"""Output of each command: its findings as tables, or the same facts as JSON."""

from __future__ import annotations

from itertools import pairwise
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from cases.kinds import AnyScene
from cases.size import spoken
from compare.cli.partition_view import show_partition
from compare.cli.terminal import print_json, say, show_numbers, show_table

if TYPE_CHECKING:
    from cases.material.calibrate import Properties
    from compare.cli.explain import Explanation
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


def show_explanation(found: Explanation, as_json: bool) -> None:
    """Print what a scene calls for, its steps, and what can solve it."""
    if as_json:
        print_json(_explanation_facts(found))
        return
    say(f"{found.scene.title} {found.scene.name}".rstrip(), "bold")
    if found.properties is not None:
        _show_properties(found.properties)
    if found.blocks is not None:
        show_partition(found.blocks)
    effects = [[e.name, "yes" if e.active else "no", e.reason] for e in found.effects]
    show_table(["effect", "computed", "because"], effects)
    steps = [
        [
            name,
            f"{r.critical:.4g}",
            f"{r.dt:.4g}",
            f"{r.dt / r.critical:.3g}",
            f"{r.steps:,}",
            spoken(r.bytes),
        ]
        for name, r in found.runs.items()
    ]
    show_table(["engine", "critical step, s", "step, s", "fraction", "steps", "memory"], steps)
    for name, reason in found.failures.items():
        say(f"{name} cannot run: {reason}")
    if found.properties is not None:
        say(_cost_sentence(found.block_step, found.with_everything))
    answers = [[k, "yes" if a else "no", a.reason] for k, a in found.answers.items()]
    show_table(["solution", "applies", "why not"], answers)
    for engine, reference in found.references.items():
        if reference is None:
            say(f"{engine} is not checked independently: no other solution resolves more")
        else:
            say(f"reference of {engine}: {reference.name} ({reference.reason})")


def _show_properties(p: Properties) -> None:
    if len(p.each) == 1:
        say(_rock_words(p))
        return
    ends = p.contact_y[np.cumsum([0, *(one.block_count for one in p.each)])].tolist()
    for (start, stop), one in zip(pairwise(ends), p.each, strict=True):
        joints = "" if isfinite(one.regular_own_stiffness) else ", without joints"
        say(f"{start:g} to {stop:g} m: {_rock_words(one)}{joints}")
    passed = [
        f"{2 * b.impedance / (a.impedance + b.impedance):.4g} at {y:g} m"
        for (a, b), y in zip(pairwise(p.each), ends[1:-1], strict=True)
    ]
    say(f"long-wave stress transmission 2 Z2 / (Z1 + Z2): {', '.join(passed)}")


def _rock_words(p: Properties) -> str:
    return (
        f"{p.block_count} blocks of {p.spacing:g} m; E_eq {p.modulus:.4g} Pa, Poisson "
        f"{p.poisson:.4g}, bar speed {p.bar_speed:.5g} m/s, K'_n {p.regular_stiffness:.4g} Pa/m"
    )


def _cost_sentence(own: float | None, everything: float | None) -> str:
    if own is None:
        return "the time per step of a rigid block is known after a run, or by --measure"
    said = f"a step of a rigid block takes {own:.2g} ns here"
    if everything is None:
        return said
    return f"{said}, {100 * own / everything:.2g} % of the {everything:.2g} ns with every effect"


def _properties_facts(p: Properties) -> dict[str, Any]:
    return {
        "blocks": p.block_count,
        "bar_speed": p.bar_speed,
        "equivalent_modulus": p.modulus,
        "poisson": p.poisson,
    }


def _explanation_facts(found: Explanation) -> dict[str, Any]:
    p = found.properties
    return {
        "title": found.scene.title,
        "variant": found.scene.name,
        **(_properties_facts(p) if p is not None else {}),
        **(found.blocks or {}),
        "effects": {e.name: {"active": e.active, "why": e.reason} for e in found.effects},
        "steps": [
            {"engine": name, "critical": r.critical, "dt": r.dt, "steps": r.steps}
            | {"bytes": r.bytes}
            for name, r in found.runs.items()
        ],
        "cannot_run": found.failures,
        "nanoseconds_per_block_step": found.block_step,
        "nanoseconds_with_everything": found.with_everything,
        "references": {k: r._asdict() if r else None for k, r in found.references.items()},
        "solutions": {k: {"applies": a.yes, "why_not": a.reason} for k, a in found.answers.items()},
    }


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
