"""The output of `jointwave plan`: the choice among its runs, and whether it meets the misfit."""

from typing import Any

from jointwave.compare.cli.terminal import print_json, say, show_table
from jointwave.compare.studies.plan import Plan, PlannedRun
from jointwave.compare.studies.reference import Reference
from jointwave.compare.text import percent


def show_plans(found: list[Plan], as_json: bool) -> None:
    """Print the choice for each scene."""
    if as_json:
        print_json([_facts(one) for one in found])
        return
    for one in found:
        _show(one)


def _show(one: Plan) -> None:
    say(f"{one.scene.title}{f', {one.scene.name}' if one.scene.name else ''}")
    say(f"modelling error: from {_named(one.finest)} ({one.reason})")
    best = one.chosen or one.nearest
    for reason in dict.fromkeys(one.skipped.values()) if best is None else ():
        say(f"skipped: {reason}")
    after = f"after {len(one.runs)} runs and {one.planning:.2g} s of planning"
    if best is None:
        asked = percent(one.asked)
        say(f"{asked} %: missed, every engine's model is further from the finest physics")
        return
    own = one.own_reference(best)
    same = "the same" if own is one.finest else _named(own)
    say(f"numerical error: from {same}, the engine's own model")
    columns = ["", "numerical, %", "modelling, %", "sum, %", "stepping, s"]
    errors = map(percent, (best.numerical, best.modelling, best.misfit))
    word = "nearest" if one.chosen is None else "chosen"
    show_table(columns, [[word, *errors, f"{best.seconds:.3g}"]])
    if (worst := one.accuracy(best)) > best.misfit:
        say(f"smaller steps are further off: {percent(worst)} %")
    say(f"{best.elements.name} {' '.join(f'--set {option}' for option in best.options)}")
    say(f"{percent(one.asked)} %: {'met' if one.is_met else 'missed'} by the sum, {after}")


def _named(reference: Reference) -> str:
    """Describe the reference of errors, its accuracy, and its time limit."""
    until = reference.result.attrs.get("known_until")
    known = "" if until is None else f", known until {float(until):.3g} s"
    if reference.settings:
        return (
            f"{reference.name} at {reference.settings}, within {percent(reference.error)} % of "
            f"the run before it{known}"
        )
    own = f", known to {percent(reference.error)} %" if reference.error else ""
    return f"the exact solution {reference.name}{own}{known}"


def _facts(one: Plan) -> dict[str, Any]:
    best = one.chosen
    facts = {
        "variant": one.scene.name,
        "reference": _reference_facts(one.finest) | {"reason": one.reason},
        "planning_seconds": one.planning,
        "runs": [_run_facts(run) for run in one.runs],
        "skipped": one.skipped,
        "met": one.is_met,
        "engine": best and best.elements.name,
    }
    if best is None:
        return facts
    return facts | {"own": _reference_facts(one.own_reference(best)), **_run_facts(best)}


def _reference_facts(reference: Reference) -> dict[str, Any]:
    about = {"error": reference.error, "settings": reference.settings}
    return {"name": reference.name, "exact": not reference.settings, **about}


def _run_facts(run: PlannedRun) -> dict[str, Any]:
    numbers = {key: getattr(run, key) for key in ("numerical", "modelling", "misfit", "seconds")}
    return {"engine": run.elements.name, "set": run.options, **numbers}
