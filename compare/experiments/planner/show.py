"""The output of `jointwave plan`: the choice as predicted and as obtained."""

from typing import Any

from compare.cli.terminal import print_json, say, show_table
from compare.experiments.common import ErrorReference
from compare.experiments.planner.planner import Plan, options_of
from compare.experiments.planner.trials import Choice
from compare.text import percent


def show_plans(found: list[Plan], misfit: float, as_json: bool) -> None:
    """Print the choice for each scene, predicted and obtained."""
    if as_json:
        print_json([_plan_facts(one, misfit) for one in found])
        return
    for one in found:
        say(f"{one.scene.title}{f', {one.scene.name}' if one.scene.name else ''}")
        say(f"modelling error: from {_named(one.reference)} ({one.reason})")
        if one.chosen is None:
            say(f"missed: no setting is predicted to reach {percent(misfit)} %")
            for reason in dict.fromkeys(one.skipped.values()):
                say(f"skipped: {reason}")
        else:
            _show_chosen(one, misfit)


def _show_chosen(one: Plan, misfit: float) -> None:
    assert one.chosen and one.own and one.obtained
    same = one.own is one.reference
    say(f"numerical error: from {'the same' if same else _named(one.own)}, the engine's own model")
    options = " ".join(f"--set {option}" for option in options_of(one.chosen))
    say(f"{one.chosen.family.name} {options}")
    columns = ["", "numerical, %", "modelling, %", "sum, %", "stepping, s"]
    show_table(
        columns,
        [["predicted", *_numbers(one.chosen)], ["obtained", *_numbers(one.obtained)]],
    )
    verdict = "met" if one.misfit <= misfit else "missed"
    say(
        f"{percent(misfit)} %: {verdict} by the sum, after {one.trials} trial runs and "
        f"{one.planning:.2g} s of planning"
    )


def _numbers(choice: Choice) -> list[str]:
    errors = choice.numerical, choice.modelling, choice.misfit
    return [*map(percent, errors), f"{choice.seconds:.3g}"]


def _named(reference: ErrorReference) -> str:
    """Describe the reference of errors, its accuracy, and its time limit."""
    until = reference.result.attrs.get("known_until")
    known = "" if until is None else f", known until {float(until):.3g} s"
    if not reference.is_exact:
        return (
            f"{reference.name} at {reference.settings}, within {percent(reference.error)} % of "
            f"the run before it{known}"
        )
    own = f", known to {percent(reference.error)} %" if reference.error else ""
    return f"the exact solution {reference.name}{own}{known}"


def _plan_facts(one: Plan, misfit: float) -> dict[str, Any]:
    facts = {
        "variant": one.scene.name,
        "reference": _reference_facts(one.reference) | {"reason": one.reason},
        "trials": one.trials,
        "planning_seconds": one.planning,
        "skipped": one.skipped,
    }
    if one.chosen is None:
        return facts | {"engine": None, "met": False}
    assert one.own and one.obtained
    return facts | {
        "engine": one.chosen.family.name,
        "own": _reference_facts(one.own),
        "set": options_of(one.chosen),
        "predicted": _choice_facts(one.chosen),
        "obtained": _choice_facts(one.obtained),
        "met": one.misfit <= misfit,
    }


def _reference_facts(reference: ErrorReference) -> dict[str, Any]:
    return {
        "name": reference.name,
        "exact": reference.is_exact,
        "error": reference.error,
        "settings": reference.settings,
    }


def _choice_facts(choice: Choice) -> dict[str, float]:
    keys = "numerical", "modelling", "misfit", "seconds"
    return {key: getattr(choice, key) for key in keys}
