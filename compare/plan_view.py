"""What was planned and what came of it, on the terminal."""

from typing import Any

from compare.plan_reference import Reference
from compare.planner import Plan, options_of
from compare.tables import percent
from compare.terminal import print_json, say, show_table


def show_plans(found: list[Plan], misfit: float, as_json: bool) -> None:
    """Print what was chosen for each scene, predicted and obtained."""
    if as_json:
        print_json([_plan_facts(one, misfit) for one in found])
        return
    for one in found:
        say(f"{one.scene.title}{f', {one.scene.name}' if one.scene.name else ''}")
        say(_against(one.reference))
        if one.chosen is None:
            say(f"missed: nothing is predicted to come within {percent(misfit)} %")
        else:
            _show_chosen(one, misfit)


def _show_chosen(one: Plan, misfit: float) -> None:
    assert one.chosen is not None
    options = " ".join(f"--set {option}" for option in options_of(one.chosen))
    say(f"{one.chosen.family.name} {options}")
    predicted = [percent(one.chosen.misfit), f"{one.chosen.seconds:.3g}"]
    obtained = [percent(one.misfit), f"{one.seconds:.3g}"]
    columns = ["", "misfit, %", "stepping, s"]
    show_table(columns, [["predicted", *predicted], ["obtained", *obtained]])
    verdict = "met" if one.misfit <= misfit else "missed"
    say(
        f"{percent(misfit)} %: {verdict}, after {one.trials} trial runs and "
        f"{one.planning:.2g} s of planning"
    )


def _against(reference: Reference) -> str:
    """Say what misfits are from."""
    if reference.is_exact:
        return f"misfit from the exact solution {reference.name}"
    return (
        f"no exact solution holds: misfit from {reference.name} at {reference.settings}, "
        f"within {percent(reference.error)} % of the run before it"
    )


def _plan_facts(one: Plan, misfit: float) -> dict[str, Any]:
    facts = {
        "variant": one.scene.name,
        "reference": one.reference.name,
        "reference_exact": one.reference.is_exact,
        "reference_error": one.reference.error,
        "trials": one.trials,
        "planning_seconds": one.planning,
        "skipped": one.skipped,
    }
    if one.chosen is None:
        return facts | {"engine": None, "met": False}
    return facts | {
        "engine": one.chosen.family.name,
        "set": options_of(one.chosen),
        "predicted": {"misfit": one.chosen.misfit, "seconds": one.chosen.seconds},
        "obtained": {"misfit": one.misfit, "seconds": one.seconds},
        "met": one.misfit <= misfit,
    }
