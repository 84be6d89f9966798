"""What effects cost and are worth, as a section of the report: table, diagram and what they say."""

from __future__ import annotations

from math import isfinite
from pathlib import Path
from typing import NamedTuple

import pandas as pd

from compare.experiments.ablation.ablation import Balance, Worth
from compare.experiments.ablation.diagram import draw
from compare.figures.export import Drawn, save
from compare.report.tables import Table, percent
from compare.runs.output import write_csv

NAME = "effects"
RESOLVED = 0.01  # of a step: less does not stand out of the clock's noise

HEADER = [
    "effect",
    "misfit without (%)",
    "of the scene's step (%)",
    "in the scene (ns)",
    "alone (ns)",
    "steps, times",
    "jointed rock (ns)",
    "why it stays",
]


class WorthSection(NamedTuple):
    """The section: its diagram, its table, what it says, the scenes that it is about, its files."""

    figure: Drawn
    sentences: list[str]
    table: Table
    scenes: str
    files: tuple[Path, ...]


def write_section(folder: Path, found: list[Balance]) -> WorthSection:
    """Write effects.csv and the diagram into `folder`; return the section."""
    csv = write_table(folder, found)
    figure = save(draw(found), folder, NAME, "What every effect costs and is worth")
    scenes = "; ".join(b.label for b in found)
    files = csv, *(figure.file(kind) for kind in ("svg", "pdf", "png"))
    return WorthSection(figure, sentences(found), table(found), scenes, files)


def write_table(folder: Path, found: list[Balance]) -> Path:
    """Write effects.csv, a row an effect of a scene, ns and ratios."""
    rows = [
        {
            "scene": b.scene,
            "variant": b.variant,
            **w._asdict(),
            "ns_bare": b.bare,
            "ns_own": b.own,
            "ns_everything": b.everything,
            "ns_rock": b.rock,
        }
        for b in found
        for w in b.effects
    ]
    named = {"alone": "ns_alone", "cost": "ns_in_scene", "rock": "ns_rock_added"}
    frame = pd.DataFrame(rows).rename(columns=named)
    return write_csv(folder / f"{NAME}.csv", frame, 6)


def table(found: list[Balance]) -> Table:
    """Return all numbers, the effects of each scene under what its own set costs."""
    stays = any(w.reason for b in found for w in b.effects)
    columns = len(HEADER) if stays else len(HEADER) - 1
    groups = {
        f"{i}. {heading(b)}": [cells(w)[:columns] for w in dearest_first(b)]
        for i, b in enumerate(found, start=1)
    }
    return Table(HEADER[:columns], groups)


def heading(b: Balance) -> str:
    """Return a scene's name and what its own set costs against everything on."""
    text = (
        f"{b.label}: {b.own:.2g} ns a block-step, {percent(b.own / b.everything)} % of "
        f"{b.everything:.2g} ns with everything on; bare {b.bare:.2g} ns"
    )
    return f"{text}; jointed rock {b.rock:.2g} ns a freedom-step" if isfinite(b.rock) else text


def dearest_first(b: Balance) -> list[Worth]:
    """Return a scene's effects by their cost, those that stay last."""
    return sorted(b.effects, key=lambda w: (bool(w.reason), -w.cost if isfinite(w.cost) else 0))


def cells(w: Worth) -> list[str]:
    """Return an effect's numbers as text, under `HEADER`."""
    if w.reason:
        return [w.effect, *[""] * 6, w.reason]
    return [
        w.effect,
        "0" if w.misfit == 0 else percent(w.misfit),
        f"{100 * w.share:.2g}",
        _signed(w.cost),
        _signed(w.alone),
        f"{w.steps:.3g}",
        _signed(w.rock),
        "",
    ]


def _signed(x: float) -> str:
    return f"{x:+.2g}" if isfinite(x) else ""


def sentences(found: list[Balance]) -> list[str]:
    """Return what the numbers say: of whole sets, of the dearest for nothing, of the best buy."""
    said = [_of_sets(found)] if found else []
    every = [(b, w) for b in found for w in b.effects if not w.reason]
    useless = [(b, w) for b, w in every if w.misfit == 0]
    useful = [(b, w) for b, w in every if w.misfit > 0]
    if useless:
        b, w = max(useless, key=lambda pair: pair[1].share)
        said.append(
            f"What costs most and changes nothing of the answer is the {w.effect}: "
            f"{percent(w.share)} % of a step of {b.label}."
        )
    if useful:
        dear = max(useful, key=lambda pair: pair[1].share)
        worth = max(useful, key=lambda pair: pair[1].misfit)
        least = min(useful, key=lambda pair: pair[1].misfit)
        said += [
            f"Of those that change it, the dearest is {_of_effect(*dear)}; worth most is "
            f"{_of_effect(*worth)}; worth least is {_of_effect(*least)}."
        ]
    return said


def _of_sets(found: list[Balance]) -> str:
    least = min(found, key=lambda b: b.own / b.everything)
    most = max(found, key=lambda b: b.own / b.everything)
    ends = [f"{percent(b.own / b.everything)} % ({b.label})" for b in (least, most)]
    return (
        "With the effects that it calls for, a scene's block-step costs "
        f"{' to '.join(dict.fromkeys(ends))} of one with everything on."
    )


def _of_effect(b: Balance, w: Worth) -> str:
    share = f"{percent(w.share)} % of a step" if w.share > RESOLVED else "nothing that shows"
    return f"{w.effect} in {b.label} ({share}, misfit {percent(w.misfit)} % without)"
