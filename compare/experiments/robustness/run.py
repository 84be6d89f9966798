"""Run the robustness suite: every case on every engine and scheme once, and the stability maps."""

from math import inf, isfinite, nan
from pathlib import Path
from time import perf_counter
from typing import NamedTuple

import numpy as np

from cases.errors import SceneError
from compare.engines import ENGINES, Progress
from compare.experiments.robustness.case import (
    SCHEMES,
    CaseTrial,
    EngineScheme,
    HardCase,
    Judgement,
)
from compare.experiments.robustness.extreme_cases import EXTREME
from compare.experiments.robustness.failing_cases import FAILING
from compare.experiments.robustness.linear_cases import LINEAR
from compare.experiments.robustness.map import StabilityMap, make_map
from compare.experiments.robustness.rock_mass_cases import ROCK_MASSES
from compare.studies import store
from compare.studies.store import FAILURES, Pool, Store

RATE = "hard case"  # key of the timings of rows
HELD, FAILED, NONE = "passed", "failed", "does not apply"
CASES: list[HardCase] = [*LINEAR, *EXTREME, *FAILING, *ROCK_MASSES]  # in the order of the report
Place = tuple[int, int]  # the numbers of a case and of an engine with its scheme


class CaseRow(NamedTuple):
    """One case on one engine and scheme, judged.

    bound, value : the criterion's bound and the value found; nan if there is none.
    margin : bound over value; infinite if the value is zero.
    state : "passed", "failed" or "does not apply"; message : why, or more about the value.
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


class Cells(NamedTuple):
    """A map in the form in which it is saved."""

    ratio: list[float]
    step: list[float]
    stable: list[list[bool]]


def places(slow: bool = True) -> list[Place]:
    """Return the places of all rows, in the order of the report; slow : also of long ones."""
    wanted = [i for i, case in enumerate(CASES) if slow or not case.slow]
    return [(i, j) for i in wanted for j in range(len(SCHEMES))]


def row_at(place: Place) -> CaseRow:
    """Return the row of one place."""
    return row_of(CASES[place[0]], SCHEMES[place[1]])


def row_of(case: HardCase, stepper: EngineScheme) -> CaseRow:
    """Return the row of a case on an engine; all errors of a run are caught."""
    began = perf_counter()
    state, (value, bound, said) = _judged(case, stepper)
    margin = bound / value if value > 0 else (inf if value == 0 else nan)
    about = case.name, stepper.engine.name, stepper.scheme, case.criterion.words
    seconds = perf_counter() - began
    return CaseRow(*about, bound, value, margin, state, said, seconds, case.scene, case.changes)


def _judged(case: HardCase, stepper: EngineScheme) -> tuple[str, Judgement]:
    trial = CaseTrial(case, stepper)
    reason = case.why_spared(stepper) or _why_not(trial)
    if reason:
        return NONE, Judgement(nan, nan, reason)
    try:
        finding = case.criterion.judge(trial)
    except FAILURES as error:
        return FAILED, Judgement(nan, nan, str(error))
    # Neither a bound that is not finite nor a nan counts as passed.
    holds = isfinite(finding.bound) and finding.value <= finding.bound
    return (HELD if holds else FAILED), finding


def _why_not(trial: CaseTrial) -> str:
    """Return why the engine and its scheme cannot solve the scene; "" if they can."""
    try:
        return trial.engine.applies(trial.own).reason
    except SceneError as error:
        return f"the scheme {error.allowed}" if error.key.endswith(".scheme") else ""


def key(place: Place) -> str:
    """Return the key of a row: everything that determines it."""
    case, stepper = CASES[place[0]], SCHEMES[place[1]]
    return store.key(case.name, case.scene, case.changes, stepper.name)


def run(
    pool: Pool | None = None,
    slow: bool = True,
    progress: Progress | None = None,
    folder: Path | None = None,
) -> list[CaseRow]:
    """Return all rows; folder : where they are saved; None: nowhere."""
    rows: Store[CaseRow] = Store(CaseRow, folder)
    return rows.compute(places(slow), key, row_at, pool, progress, RATE)


def run_maps(pool: Pool | None, folder: Path) -> list[StabilityMap]:
    """Return the maps of all engines, saved in `folder`."""
    found = Store[Cells](Cells, folder).compute(list(ENGINES), store.key, cells, pool)
    return [StabilityMap(e, *map(np.array, one)) for e, one in zip(ENGINES, found, strict=True)]


def cells(engine: str) -> Cells:
    """Return the map of an engine as lists."""
    return Cells(*(part.tolist() for part in make_map(engine)[1:]))
