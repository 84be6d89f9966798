"""Output of `jointwave explain`: what a scene has; what it has not, and why, on request."""

from typing import Any

from jointwave.cases.size import spoken
from jointwave.compare.cli.terminal import say, show_facts
from jointwave.compare.engines import ENGINES, in_words, label_of, solver
from jointwave.compare.runs.jobs import options_of
from jointwave.compare.text import in_seconds, percent

#: The units of facts, and what facts are called whose names do not say it.
UNITS = {
    "m": "from to block length centroid width",
    "m²": "area",
    "m³": "volume",
    "m/s": "bar_speed shear_speed intact_bar_speed velocity p_speed s_speed",
    "Pa": "equivalent_modulus stress",
    "Pa/m": "joint_stiffness",
    "Pa s/m": "impedance",
    "J/m²": "energy",
    "bytes": "bytes",
}
LABELS = {key: f"{key} ({unit})" for unit, keys in UNITS.items() for key in keys.split()} | {
    "bytes": "memory of the blocks (bytes)",
    "bytes_at_most": "memory while they are cut, at most (bytes)",
    "boundary": "contacts with the boundary",
    "largest": "largest block",
    "poisson": "Poisson's ratio",
    "rigid_blocks_lack": "part of the intact rock's stiffness that rigid blocks cannot represent",
    "smallest": "smallest block",
    "source": "what enters",
    "speeds": "speeds of P and S waves (m/s)",
    "transmission": "transmission from the segment before",
}
APART = {"title", "variant", "effects", "steps", "limits_the_step", "cannot_run", "solutions"}
APART |= {"references"}


def show_explanation(found: dict[str, Any], every: bool) -> None:
    """Print the facts of a scene; every : also effects and solutions that it has not, and why."""
    say(f"{found['title']} {found['variant']}".rstrip(), "bold")
    facts = {key: value for key, value in found.items() if key not in APART}
    speeds = {label_of(name): one for name, one in found.get("speeds", {}).items()}
    show_facts(facts | ({"speeds": speeds} if speeds else {}), LABELS)
    effects = [
        {"effect": name, "active": one["active"], "why": one["why"]}
        for name, one in found["effects"].items()
    ]
    _show("effects are not active", effects, "active", every)
    solutions = [
        {
            "solution": label_of(name),
            "applies": one["applies"],
            "options": " ".join(options_of(name)),
            "why_not": in_words(one["why_not"]),
        }
        for name, one in found["solutions"].items()
    ]
    steps = [
        {
            "engine": label_of(run["engine"]),
            "step": in_seconds(run["dt"]),
            "critical_step": in_seconds(run["critical"]) if run["critical"] else None,
            "steps": run["steps"],
            "memory": spoken(run["bytes"]),
        }
        for run in found["steps"]
    ]
    say("")
    show_facts({"steps": steps})
    for limit in found["limits_the_step"]:
        say(_limit(**limit))
    for name, why in found["cannot_run"].items():
        say(f"{label_of(name)} cannot run: {why}", "red")
    _show("solutions do not apply", solutions, "applies", every)
    for name in () if every else ENGINES:
        if name in found["solutions"] and not found["solutions"][name]["applies"]:
            say(f"not by {label_of(name)}: {in_words(found['solutions'][name]['why_not'])}", "dim")
    for name, reference in found["references"].items():
        by, why = label_of(reference["name"]), reference["reason"]
        say(f"reference of {label_of(name)}: {f'{by} ({why})' if by else why}")


def _show(rest: str, rows: list[dict[str, Any]], key: str, every: bool) -> None:
    """Print the rows that hold by a key, and how many do not, in words; every : all of them."""
    say("")
    empty = {name for name in rows[0] if all(not row[name] for row in rows if row[key])}
    few = [{k: v for k, v in row.items() if k not in {key, *empty}} for row in rows if row[key]]
    show_facts({rest: rows if every else few})
    if (left := len(rows) - len(few)) and not every:
        say(f"{left} other {rest}; which, and why: --all", "dim")


def _limit(engine: str, at: list[float], size: float, longer_step: float, mass_added: float) -> str:
    """Return what limits a step, and what lifting it costs, as a sentence."""
    part = "block" if solver(engine).has_rigid_blocks else "element"
    place = ", ".join(f"{round(x, 9) + 0.0:.4g}" for x in at)
    return (
        f"the step of {label_of(engine)} is limited by the {part} at {place} m, {size:.3g} m in "
        f"size: {percent(mass_added)} % more mass, on at most 5 % of the {part}s, would make it "
        f"{longer_step:.3g} times as long"
    )
