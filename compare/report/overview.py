"""The first screen: how far apart the engines are on every scene, and what each costs."""

from collections.abc import Sequence
from math import isnan

from jointwave.compare.engines import ENGINES, label_of
from jointwave.compare.report.scenes import SolvedScene
from jointwave.compare.report.verdict import NOT_CHECKED
from jointwave.compare.text import in_seconds, percent, span, times

FEW = 2  # references that are named
CLOSE = 0.2  # the largest misfit that a solution is said to be within


def lead(scenes: Sequence[SolvedScene]) -> dict[str, str]:
    """Return a sentence on each engine that solves a scene."""
    found = {e: [one for one in scenes if e in one.scores] for e in ENGINES}
    return {engine: _sentence(engine, solved) for engine, solved in found.items() if solved}


def _sentence(engine: str, scenes: list[SolvedScene]) -> str:
    """Return how far an engine lies from the finest physics, by kind of scene, and at what cost."""
    kinds = dict.fromkeys(one.scene.kind for one in scenes)
    of_kind = {kind: [one for one in scenes if one.scene.kind == kind] for kind in kinds}
    apart = [
        _distance(engine, some, f" for the {kind}{'s' * (len(some) > 1)}" * (len(kinds) > 1))
        for kind, some in of_kind.items()
    ]
    costs = [one.costs[engine] for one in scenes]
    cost = f"{span(costs, times)} the time of the cheapest"
    if max(costs) == 1:
        cost = f"the cheapest: {span((one.seconds[engine] for one in scenes), in_seconds)} a run"
    return f"{ENGINES[engine].sentence} {' and '.join(apart)}; {cost}."


def _distance(engine: str, scenes: list[SolvedScene], of: str) -> str:
    """Return the largest misfit from the references, which are named if there are few; of : which
    scenes, in words."""
    scores = [one.scores[engine] for one in scenes]
    found = [x for one in scores if not isnan(x := one.total.judged)]
    if not found:
        return NOT_CHECKED.word + of
    against = dict.fromkeys(v.against for one in scores for v in one.variants if v.against)
    names = " or ".join(map(_reference, against)) if len(against) <= FEW else "the finest physics"
    apart = percent(max(found), 2).removeprefix("< ")
    close = max(found) <= CLOSE
    said = f"within {apart} % of {names}" if close else f"up to {apart} % from {names}"
    unchecked = sum(bool(one.unchecked) for one in scores)
    return f"{said}{of}" + f" ({unchecked} of {len(scenes)} {NOT_CHECKED.word})" * bool(unchecked)


def _reference(name: str) -> str:
    label = label_of(name)
    exact = label.removesuffix(", exact")
    return label if exact == label else f"the exact {exact}"
