"""One scene: what was planned, held against the cheapest of the full study, timed in turns."""

from math import inf, nan
from statistics import median

from full_study import Study

from cases.kinds import AnyScene
from compare.engines import solve
from compare.experiments.common import FAILURES, reason_of
from compare.experiments.planner.choices import Choice
from compare.experiments.planner.families import configured
from compare.experiments.planner.planner import Plan, options_of, plan
from compare.experiments.planner.reference import References

RIVALS = 4  # of the study: the cheapest by their own timing, which is noise for short runs
SHORT = 0.05  # s: the longest run that takes part in all rounds; three are enough above


def rows_of(scene: AnyScene, misfits: list[float], rounds: int) -> list[dict]:
    """Return a row for each misfit; a scene that cannot be planned has its reason."""
    try:
        references = References(scene, min(misfits))
    except FAILURES as error:
        return [_row(scene, m) | {"message": reason_of(error)} for m in misfits]
    study = Study(scene, references, misfits)
    return [_held(scene, study, m, rounds) for m in misfits]


def _held(scene: AnyScene, study: Study, misfit: float, rounds: int) -> dict:
    found, rivals = plan(scene, misfit), study.best(misfit)[:RIVALS]
    row = _row(scene, misfit) | _of_plan(found, misfit) | {"points": len(study.points)}
    seconds = _in_turns(scene, [c for c in (found.chosen, *rivals) if c is not None], rounds)
    if rivals:
        best = min(rivals, key=lambda c: seconds[_key(c)])
        row |= {
            "best": _text(best),
            "best_misfit": best.misfit,
            "best_seconds": seconds[_key(best)],
        }
    if found.chosen is not None:
        row["seconds"] = seconds[_key(found.chosen)]
    if rivals and found.chosen is not None:
        row["ratio"] = row["seconds"] / row["best_seconds"]
    return row


def _in_turns(scene: AnyScene, choices: list[Choice], rounds: int) -> dict[str, float]:
    """Return the median seconds of stepping of each configuration, all run in every round."""
    runs = {_key(c): (c.family.name, configured(scene, c.family, c.settings)) for c in choices}
    taken: dict[str, list[float]] = {key: [] for key in runs}
    for i in range(rounds + 1):
        for key, (name, asked) in runs.items():
            if len(taken[key]) < 3 or median(taken[key]) < SHORT:
                spent = float(solve(name, asked).attrs["seconds_stepping"])
                if i:  # the first is cold
                    taken[key].append(spent)
    return {key: median(spent) for key, spent in taken.items()}


def _key(choice: Choice) -> str:
    return " ".join(options_of(choice)) + choice.family.name


def _text(choice: Choice) -> str:
    (fraction,) = choice.settings.values()
    return f"{choice.family.label} {fraction:.3g}"


def _row(scene: AnyScene, misfit: float) -> dict:
    return {"variant": scene.name, "asked": misfit, "met": False, "ratio": nan, "message": ""}


def _of_plan(found: Plan, misfit: float) -> dict:
    about = {
        "reference": found.reference.name,
        "reference_error": found.reference.error,
        "trials": found.trials,
        "planning": found.planning,
        "met": found.misfit <= misfit,
    }
    if found.chosen is None:
        return about | {"chosen": "", "message": "nothing is predicted to meet it"}
    return about | {
        "chosen": _text(found.chosen),
        "modelling": found.chosen.modelling,
        "predicted_misfit": found.chosen.misfit,
        "misfit": found.misfit if found.misfit < inf else nan,
        "predicted_seconds": found.chosen.seconds,
        "obtained_seconds": found.seconds,
    }
