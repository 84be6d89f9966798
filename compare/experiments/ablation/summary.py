"""The summary of an ablation: the table, the diagram, and findings in sentences."""

from math import isfinite
from pathlib import Path

import pandas as pd

from compare.experiments.ablation.ablation import Ablation, EffectCost
from compare.experiments.ablation.diagram import draw
from compare.figures.export import save
from compare.runs.output import write_csv
from compare.studies.summary import Summary, number, text_table
from compare.text import percent

NAME = "effects"
TITLE = "Cost and influence of each effect"
COLUMNS = [
    "effect",
    "misfit without (%)",
    "of the scene's step (%)",
    "in the scene (ns)",
    "alone (ns)",
    "steps, ratio",
    "jointed rock (ns)",
    "why it is required",
]


def summarise(folder: Path, found: list[Ablation]) -> Summary:
    """Return the summary; write effects.csv and the diagram into `folder`."""
    csv = write_table(folder, found)
    figure = save(draw(found), folder, NAME, TITLE)
    return Summary(
        NAME,
        TITLE,
        table(found),
        sentences(found),
        [],
        [csv, *figure.drawings],
        found,
        figure,
        about="; ".join(a.label for a in found),
        timed=True,
    )


def write_table(folder: Path, found: list[Ablation]) -> Path:
    """Write effects.csv, one row per effect of a scene, ns and ratios."""
    rows = [
        {
            "scene": a.scene,
            "variant": a.variant,
            **{key: value for key, value in e._asdict().items() if key != "noise"},
            **{f"{key}_noise": value for key, value in e.noise.items()},
            "ns_bare": a.bare,
            "ns_own": a.own,
            "ns_everything": a.everything,
            "ns_rock": a.rock,
        }
        for a in found
        for e in a.effects
    ]
    named = {"alone": "ns_alone", "cost": "ns_in_scene", "rock": "ns_rock_added"}
    named |= {f"{key}_noise": f"{name}_noise" for key, name in named.items()}
    return write_csv(folder / f"{NAME}.csv", pd.DataFrame(rows).rename(columns=named), 6)


def table(found: list[Ablation]) -> pd.DataFrame:
    """Return all numbers, the effects of each scene below the cost of its own set, highest first.

    The last column exists if any effect cannot be left out.
    """
    stays = any(e.reason for a in found for e in a.effects)
    columns = len(COLUMNS) if stays else len(COLUMNS) - 1
    rows = [
        (f"{i}. {_heading(a)}", _cells(e)[:columns])
        for i, a in enumerate(found, start=1)
        for e in sorted(a.effects, key=_dearest)
    ]
    return text_table(COLUMNS[:columns], rows)


def _heading(a: Ablation) -> str:
    text = (
        f"{a.title} ({a.label}): {a.own:.2g} ns a block-step, {percent(a.own / a.everything)} % of "
        f"{a.everything:.2g} ns with everything on; bare {a.bare:.2g} ns"
    )
    return f"{text}; jointed rock {a.rock:.2g} ns a freedom-step" if isfinite(a.rock) else text


def _dearest(e: EffectCost) -> tuple[bool, float]:
    return bool(e.reason), -e.cost if isfinite(e.cost) else 0


def _cells(e: EffectCost) -> list[str]:
    if e.reason:
        return [e.effect, *[""] * 6, e.reason]
    misfit = "0" if e.misfit == 0 else percent(e.misfit) if isfinite(e.misfit) else ""
    stirred = f"{e.stirred} is at rest with it: not resolved" if e.stirred else ""
    return [
        e.effect,
        "; ".join(filter(None, [misfit, stirred])),
        f"{100 * e.share:.2g}" if e.is_resolved("cost") else "not resolved",
        *(_ns(e, name) for name in ("cost", "alone")),
        f"{e.steps:.3g}",
        _ns(e, "rock"),
        "",
    ]


def _ns(e: EffectCost, name: str) -> str:
    """Return a cost in ns, or the noise that it does not exceed."""
    cost = getattr(e, name)
    if e.is_resolved(name) or not isfinite(cost):
        return number(cost, "+.2g")
    return f"not resolved (within ±{e.noise[name]:.1g})"


def sentences(found: list[Ablation]) -> list[str]:
    """Return the extremes: of whole sets, of effects without influence, and of those with."""
    said = [_of_sets(found)] if found else []
    every = [(a, e) for a in found for e in a.effects if not e.reason]
    idle = [(a, e) for a, e in every if e.misfit == 0]
    active = [(a, e) for a, e in every if e.misfit > 0]
    idle = [(a, e) for a, e in idle if e.is_resolved("cost")]
    if idle:
        a, e = max(idle, key=lambda pair: pair[1].share)
        said.append(
            f"The most expensive effect that does not change the result is the {e.effect}: "
            f"{percent(e.share)} % of a step of {a.label}."
        )
    if len(active) == 1:
        said.append(f"The only one that changes it is {_of_effect(*active[0])}.")
    elif active:
        dearest = max(active, key=lambda pair: pair[1].share)
        most = max(active, key=lambda pair: pair[1].misfit)
        least = min(active, key=lambda pair: pair[1].misfit)
        said.append(
            f"Of those that change it, the most expensive is {_of_effect(*dearest)}; "
            f"the most influential is {_of_effect(*most)}, the least is {_of_effect(*least)}."
        )
    return said


def _of_sets(found: list[Ablation]) -> str:
    parts = sorted((a.own / a.everything, a.label) for a in found)
    ends = [f"{percent(share)} % ({label})" for share, label in (parts[0], parts[-1])]
    return (
        "With the effects that a scene needs, its block-step costs "
        f"{' to '.join(dict.fromkeys(ends))} of one with everything on."
    )


def _of_effect(a: Ablation, e: EffectCost) -> str:
    share = "no measurable cost"
    if e.is_resolved("cost"):
        share = f"{percent(abs(e.share))} % of a step{' less with it' if e.share < 0 else ''}"
    return f"{e.effect} in {a.label} ({share}, misfit {percent(e.misfit)} % without)"
