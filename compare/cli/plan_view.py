"""The output of `jointwave plan`: the choice among its runs, and whether it meets the misfit."""

import shlex
from typing import Any

from jointwave.compare.cli.terminal import print_json, say, show_table
from jointwave.compare.engines import label_of
from jointwave.compare.runs.jobs import options_of
from jointwave.compare.studies.plan import Plan, PlannedRun
from jointwave.compare.studies.reference import Reference
from jointwave.compare.text import percent


def show_plans(found: list[Plan], path: str, changes: list[str], as_json: bool) -> None:
    """Print the choice for each scene, with the command that runs it.

    path, changes : of the scene, as the user gives them.
    """
    if as_json:
        print_json([_facts(one) for one in found])
        return
    for one in found:
        _show(one, path, changes)


def _show(one: Plan, path: str, changes: list[str]) -> None:
    say(", ".join(filter(None, [one.scene.title, one.scene.name])))
    why = "" if one.finest.settings else f" ({one.reason})"
    say(f"modelling error: against {_named(one.finest)}{why}")
    best, asked = one.chosen, percent(one.asked)
    if best is None:
        for reason in dict.fromkeys(one.skipped.values()):
            say(f"skipped: {reason}")
        say(f"{asked} % is not met: no engine's model is near enough to the finest physics in time")
        return
    say(f"numerical error: against {_named(best.reference)}, the engine's own model")
    errors = [percent(x) for x in (best.numerical, best.modelling, best.misfit, one.misfit)]
    columns = ["numerical", "modelling", "sum", "sum with smaller steps"]
    columns = ["engine", *(f"{name} (%)" for name in columns), "stepping (s)"]
    show_table(columns, [[label_of(best.elements.name), *errors, f"{best.seconds:.3g}"]])
    chosen = ["jointwave", "run", path, "--variant", one.scene.name]
    chosen += options_of(best.elements.name)
    chosen += [part for text in [*changes, *best.options] for part in ("--set", text)]
    say(shlex.join(chosen))
    met = "the sum of errors meets" if one.is_met else "the nearest run, whose sum misses,"
    say(f"{met} {asked} %; planning took {len(one.runs)} runs and {one.planning:.2g} s")


def _named(reference: Reference) -> str:
    """Describe the reference of errors, its accuracy, and its time limit."""
    words = label_of(reference.name) + f" at {reference.settings}" * bool(reference.settings)
    if reference.error:
        words += f", accurate to {percent(reference.error)} %"
    until = reference.result.attrs.get("known_until")
    return words if until is None else f"{words}, valid until {float(until):.3g} s"


def _facts(one: Plan) -> dict[str, Any]:
    return {
        "variant": one.scene.name,
        "reference": _reference_facts(one.finest) | {"reason": one.reason},
        "planning_seconds": one.planning,
        "runs": [_run_facts(run) for run in one.runs],
        "skipped": one.skipped,
        "met": one.is_met,
        **(_run_facts(one.chosen) if one.chosen else {"engine": None}),
    }


def _reference_facts(reference: Reference) -> dict[str, Any]:
    about = {"error": reference.error, "settings": reference.settings}
    return {"name": reference.name, "exact": not reference.settings, **about}


def _run_facts(run: PlannedRun) -> dict[str, Any]:
    numbers = {key: getattr(run, key) for key in ("numerical", "modelling", "misfit", "seconds")}
    about = {"engine": run.elements.name, "set": run.options, **numbers}
    return about | {"own": _reference_facts(run.reference)}
