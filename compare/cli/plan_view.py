"""The output of `jointwave plan`: the choice among its runs, and whether it meets the misfit."""

import shlex

from jointwave.compare.cli.terminal import say, show_table
from jointwave.compare.engines import label_of
from jointwave.compare.runs.jobs import options_of
from jointwave.compare.studies.plan import Plan
from jointwave.compare.studies.reference import Reference
from jointwave.compare.text import percent


def show_plan(one: Plan, path: str, changes: list[str]) -> None:
    """Print the choice for a scene, with the command that runs it.

    path, changes : of the scene, as the user gives them.
    """
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
