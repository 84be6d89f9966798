"""What was planned and what came of it, on the terminal."""

from typing import Any

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
        if one.chosen is None:
            say(f"nothing is predicted to come within {percent(misfit)} % of {one.reference}")
        else:
            options = " ".join(f"--set {option}" for option in options_of(one.chosen))
            say(f"{one.chosen.family.name} {options}")
            columns = ["", "misfit, %", "stepping, s"]
            obtained = ["obtained", percent(one.misfit), f"{one.seconds:.3g}"]
            predicted = [percent(one.chosen.misfit), f"{one.chosen.seconds:.3g}"]
            show_table(columns, [["predicted", *predicted], obtained])
            verdict = "met" if one.misfit <= misfit else "missed"
            say(f"{percent(misfit)} % of {one.reference}: {verdict}, after {one.trials} trial runs")


def _plan_facts(one: Plan, misfit: float) -> dict[str, Any]:
    facts = {"variant": one.scene.name, "reference": one.reference, "trials": one.trials}
    if one.chosen is None:
        return facts | {"engine": None, "met": False, "skipped": one.skipped}
    return facts | {
        "engine": one.chosen.family.name,
        "set": options_of(one.chosen),
        "predicted": {"misfit": one.chosen.misfit, "seconds": one.chosen.seconds},
        "obtained": {"misfit": one.misfit, "seconds": one.seconds},
        "met": one.misfit <= misfit,
        "skipped": one.skipped,
    }
