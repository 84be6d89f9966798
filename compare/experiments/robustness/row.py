"""One line of the battery: a case on one solver, judged."""

from __future__ import annotations

from math import inf, isfinite
from time import perf_counter
from typing import NamedTuple

from cases.errors import SceneError, UnstableError
from compare.engines import applies
from compare.experiments.robustness.case import Case, Finding, Solver, Trial, is_refusal_of_scheme

HELD, FAILED, NONE = "held", "failed", "does not apply"


class Row(NamedTuple):
    """One case on one solver.

    bound, value : what the criterion bounds and what was found; nan where nothing was.
    margin : bound over value; infinite where the value is zero.
    state : "held", "failed" or "does not apply"; message : why, or more about the value.
    """

    case: str
    engine: str
    scheme: str
    criterion: str
    bound: float
    value: float
    margin: float
    state: str
    message: str
    seconds: float
    scene: str
    changes: dict


def row_of(case: Case, solver: Solver) -> Row:
    """Return the row of a case on a solver; nothing that a run can meet escapes it."""
    began = perf_counter()
    state, finding = _judged(case, solver)
    value, bound = finding.value, finding.bound
    margin = bound / value if value > 0 else (inf if value == 0 else float("nan"))
    about = case.name, solver.engine, solver.scheme, case.criterion
    seconds = perf_counter() - began
    return Row(*about, bound, value, margin, state, finding.said, seconds, case.scene, case.changes)


def _judged(case: Case, solver: Solver) -> tuple[str, Finding]:
    """Return the state of a row and what was found."""
    nothing = float("nan")
    reason = case.why_spared(solver) or _why_not(case, solver)
    if reason:
        return NONE, Finding(nothing, nothing, reason)
    try:
        finding = case.judge(Trial(case, solver))
    except (SceneError, UnstableError) as error:
        return FAILED, Finding(nothing, nothing, str(error))
    # A bound that is not finite bounds nothing, and nan is at most nothing.
    holds = isfinite(finding.bound) and finding.value <= finding.bound
    return (HELD if holds else FAILED), finding


def _why_not(case: Case, solver: Solver) -> str:
    """Return why the solver cannot solve the scene; "" where it can."""
    try:
        scene = Trial(case, solver).scene()
    except SceneError as error:
        if is_refusal_of_scheme(error):
            return f"the scheme {error.allowed}"
        return ""
    answer = applies(solver.engine, scene)
    return "" if answer else answer.reason
