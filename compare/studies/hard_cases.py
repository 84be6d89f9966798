"""The study of hard cases: every scene of cases/hard on every engine with every time integrator.

A run passes if it ends as it should, its energy ledger closes, its dissipated energy never falls,
and its misfit from the exact solution is within the bound of its scene.

Energy: with linear joints leapfrog conserves the ledger to LINEAR. If a joint opens within a step,
the trapezoidal work of its force is wrong by at most K (v dt)^2 / 8: at a twentieth of the critical
step 3e-4 of m v^2 / 2, hence OPENING. Implicit steps damp on purpose, so only their dissipation is
bounded. Dissipated energy may fall by round-off, STEP times the number of steps.
Misfit: the bounds of [expect] are for explicit steps. Implicit steps add a relative frequency error
(omega dt)^2 / 6, i.e. a phase error (omega dt)^2 omega t / 6 at the end of a run, averaged over the
spectrum of a Ricker wavelet (CUBES). Steps above the critical one are refused or, if the scene
allows them, stopped by the divergence monitor.
"""

from collections.abc import Sequence
from contextlib import suppress
from functools import partial
from math import inf, isfinite, nan, pi
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from jointwave import cases
from jointwave.cases.effects import active_effects
from jointwave.cases.errors import SceneError, UnstableError
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.schema.pulse import shortest_period
from jointwave.compare.engines import ENGINES, applies, label_of, solver
from jointwave.compare.figures.export import save
from jointwave.compare.misfit.metrics import misfit
from jointwave.compare.runs.output import write_csv
from jointwave.compare.runs.timings import solved
from jointwave.compare.scenes import bound_of, find, shipped
from jointwave.compare.studies import hard_map, store
from jointwave.compare.studies.experiment import Experiment, Summary
from jointwave.compare.studies.forecast import Run
from jointwave.compare.studies.store import Row
from jointwave.results.dataset import energy_residual, scene_hash

NAME = "stability"
TITLE = "Hard cases for both engines, and the margin by which they hold"
NOTE = (
    "Stable and unstable cells as computed, under the theoretical limit. The table has every hard "
    "case on every engine and scheme: the imbalance of its energy ledger and the largest decrease "
    "of what it has dissipated, over the work, its misfit, and the least bound over its value."
)
STABLE, REFUSED, STOPPED, NONE = "stable", "refused", "stopped", "does not apply"
LINEAR, OPENING, STEP = 1e-10, 1e-3, 1e-15  # bounds on energy, over the work
CUBES = 2.22  # root mean square of f^3 over the spectrum f^2 exp(-f^2), whose peak is at f = 1
NONLINEAR = {"slip", "softening", "no tension", "closure"}
SPENT = ("viscous", "friction", "fracture")
#: A short blow that excites all modes of the pillar, for steps above the critical one.
RINGING = {"load.period": 1e-3, "time.duration": 2.0, "record.interval": 1.0}
FRACTION = 1.001  # of the critical step
ABOVE_CRITICAL = f"{FRACTION:g} of the critical step"


#: Columns of a case: its scene, variant, engine, scheme, and how its run should end; how and why it
#: ended; over the work: the imbalance of the energy ledger and the largest fall of dissipated
#: energy; the misfit from `reference`; the bounds of these. What is not checked is missing.
POINT = ("scene", "variant", "engine", "scheme", "should")
NUMBERS = ("energy", "energy_bound", "fall", "fall_bound", "misfit", "misfit_bound")
COLUMNS = (*POINT, "ended", *NUMBERS, "reference", "message")


def title_of(row: Row) -> str:
    """Return the title of a case in the table: its scene, variant and step."""
    steps = {REFUSED: ABOVE_CRITICAL, STOPPED: f"{ABOVE_CRITICAL}, allowed"}
    parts = row["scene"].partition("/")[2], row["variant"], steps.get(row["should"])
    return ", ".join(filter(None, parts))


def judged(rows: Sequence[Row]) -> pd.DataFrame:
    """Return the table of all cases with `title`, `name`, `margin` (the least bound / value, inf
    without bounds, nan if a value is nan) and `holds`: ended as it should, within all bounds."""
    found = pd.DataFrame(rows, columns=COLUMNS).astype(dict.fromkeys(NUMBERS, float))
    texts = found[["reference", "message"]].fillna("")
    values, bounds = found[[*NUMBERS[::2]]].to_numpy(), found[[*NUMBERS[1::2]]].to_numpy()
    with np.errstate(divide="ignore"):
        margin = np.where(np.isfinite(bounds), bounds / values, inf).min(axis=1)
    title = found.apply(title_of, axis=1)
    how = found.engine.map(label_of) + ", " + found.scheme
    holds = ((found.ended == found.should) | (found.ended == NONE)) & (margin >= 1)
    about = {"title": title, "how": how, "name": title + ", " + how}
    return found.assign(**texts, **about, margin=margin, holds=holds)


def hard_cases() -> list[Row]:
    """Return all cases, not run yet: variants of cases/hard, and runs above the critical step."""
    found = [
        (name, scene.name, engine.name, scheme)
        for name in shipped()
        if name.startswith("hard/")
        for scene in cases.load(find(name))
        for engine in ENGINES.values()
        for scheme in engine.schemes
        if scene.is_column or scheme in ("leapfrog", "explicit")
    ]
    short = [one for one in found if one[:2] == (hard_map.SCENE, "") and one[3] != "implicit"]
    ends = [(one, STABLE) for one in found]
    ends += [(one, state) for one in short for state in (REFUSED, STOPPED)]
    return [dict(zip(POINT, (*one, state), strict=True)) for one, state in ends]


def scene_of(row: Row) -> AnyScene:
    """Return the scene of a case; raises SceneError if it is invalid."""
    table = f"numerics.{ENGINES[row['engine']].engine}"
    changes: dict[str, Any] = {}
    if row["scheme"] != "leapfrog":  # the only one of rigid blocks in the plane
        changes[f"{table}.scheme"] = row["scheme"]
    if row["should"] != STABLE:
        changes |= RINGING | {f"{table}.step_fraction": FRACTION}
        changes[f"{table}.allow_unstable"] = row["should"] == STOPPED
    return cases.load_variant(find(row["scene"]), row["variant"], changes)


def run(row: Row) -> Row:
    """Run a case and return it with its results; errors of a run become its state `ended`."""
    try:
        scene = scene_of(row)
        if reason := applies(row["engine"], scene).reason:
            return row | {"ended": NONE, "message": reason}
        result, _ = solved(row["engine"], scene)
    except UnstableError as error:
        return row | {"ended": STOPPED, "message": str(error).partition(": ")[2]}
    except SceneError as error:
        ended = NONE if error.key.endswith(".scheme") else REFUSED
        return row | {"ended": ended, "message": error.allowed}
    found = _of_energy(row["scheme"], scene, result) | _of_misfit(row, scene, result)
    return row | {"ended": STABLE} | found


def _of_energy(scheme: str, scene: AnyScene, result: xr.Dataset) -> dict[str, Any]:
    if "energy" not in result:
        return {}
    found = {"fall": largest_fall(result), "fall_bound": STEP * float(result.attrs["steps"])}
    if scheme != "implicit":
        conserves = scheme != "fourth-order" and NONLINEAR.isdisjoint(active_effects(scene))
        bound = LINEAR if conserves else OPENING
        found |= {"energy": energy_residual(result), "energy_bound": bound}
    return found


def _of_misfit(row: Row, scene: AnyScene, result: xr.Dataset) -> dict[str, Any]:
    """Return the misfit from the first exact solution that the scene expects and that applies."""
    for key, bound in scene.expect.items():
        first, other, of = bound_of(key)
        if first == row["engine"] and not of and solver(other).exact and applies(other, scene):
            if row["scheme"] == "implicit":  # nan for a jump, which has no shortest period
                omega, end = 2 * pi / (shortest_period(scene.pulses) or nan), scene.time.duration
                bound += (omega * end / result.attrs["steps"]) ** 2 / 6 * CUBES * omega * end
            found = misfit(result, solved(other, scene)[0])
            return {"misfit": found, "misfit_bound": bound, "reference": other}
    return {}


def largest_fall(result: xr.Dataset) -> float:
    """Return the largest decrease of dissipated energy over the largest work.

    The viscous term alone may fall: at a sliding joint, a dashpot whose spring unloads drives the
    slip, which friction then dissipates.
    """
    work = float(np.abs(result.energy.sel(term="work")).max())
    spent = {t: result.energy.sel(term=t).values for t in SPENT if t in result.term.values}
    rows = [sum(spent.values()), *(row for t, row in spent.items() if t != "viscous")]
    falls = [float((np.maximum.accumulate(row) - row).max()) for row in rows if np.ndim(row)]
    return max(falls, default=0.0) / work if work else 0.0


def experiment(out: Path) -> Experiment:
    """Return the study of the maps and of all cases, saved in OUT/stability/, with files in `out`.

    A point is a case or, with a `ratio`, a column of a map.
    """
    # The columns last: they are short, so all processes end at nearly the same time.
    points, summary = [*hard_cases(), *hard_map.columns()], partial(summarise, out)
    return Experiment(TITLE, points, out / NAME, key, measure, summary, runs)


def key(point: Row) -> str:
    """Return the key of a point, a hash of everything that determines its row."""
    if "ratio" in point:
        return store.key(point)
    scene = cases.load_variant(find(point["scene"]), point["variant"])
    return store.key(point, scene_hash(scene))


def measure(point: Row) -> Row:
    """Return a case with its results, or a column of a map with its cells."""
    return hard_map.computed(point) if "ratio" in point else run(point)


def runs(points: Sequence[Row]) -> list[Run]:
    """Return the runs of cases and of their exact solutions, and of the stable cells of maps."""
    found = [Run("maps", *hard_map.cells_to_run(one)) for one in points if "ratio" in one]
    for row in (one for one in points if "ratio" not in one):
        with suppress(SceneError):
            scene, engine = scene_of(row), row["engine"]
            bounds = (bound_of(key) for key in scene.expect)
            exact = (one.other for one in bounds if one.one == engine and not one.of)
            names = [engine, *(one for one in exact if one not in ENGINES)][:2]
            solver(engine).prepare(scene)
            found += [Run("cases", scene, one) for one in names if applies(one, scene)]
    return found


def summarise(out: Path, found: Sequence[Row]) -> Summary:
    """Return the summary of maps and cases; write their tables and the figure into `out`."""
    cells = hard_map.cells_of([one for one in found if "ratio" in one])
    rows = judged([one for one in found if "ratio" not in one])
    drawn = save(hard_map.draw_maps(cells), out, NAME, TITLE)
    tables = {NAME: rows[[*COLUMNS]], f"{NAME}-map": cells}
    files = [write_csv(out / f"{name}.csv", table) for name, table in tables.items()]
    files.append(drawn.file("svg"))
    failed = [f"{row.name}: {row.ended} {row.message}" for row in rows[~rows.holds].itertuples()]
    shown = table(rows), sentences(rows, cells), failed, files
    data = {"rows": tables[NAME].to_dict("records")}
    return Summary(NAME, TITLE, *shown, data, drawn, about=NOTE)


def table(rows: pd.DataFrame) -> pd.DataFrame:
    """Return judged cases under headings of their titles."""
    said = rows.message.where(rows.message != "", "misfit from " + rows.reference)
    said = said.where((rows.message + rows.reference) != "", "")
    found = rows.rename(columns={"ended": "ends", "fall": "decrease"})
    found[""] = said.where(rows.holds, "failed: " + said)
    found = found[["ends", "energy", "decrease", "misfit", "margin", ""]]
    labels = [rows.title, rows.how]
    return found.set_index(pd.MultiIndex.from_arrays(labels, names=["", "engine and scheme"]))


def sentences(rows: pd.DataFrame, cells: pd.DataFrame) -> list[str]:
    """Return the number of cases that hold, the least margin, and cells that contradict theory."""
    tried = rows[rows.ended != NONE]
    held = tried[tried.holds].sort_values("margin", kind="stable")
    found = [
        f"{len(held)} of {len(tried)} rows hold; {len(rows) - len(tried)} do not apply, each with "
        "its reason."
    ]
    if len(held) and isfinite(least := held.margin.iloc[0]):
        found.append(f"The least margin is {least:.3g}: {held['name'].iloc[0]}.")
    return found + [
        f"{label_of(str(engine))}: {len(own):,} cells, {own.wrong.sum()} on the wrong side of the "
        f"line, {own.far.sum()} of them beyond one cell of it."
        for engine, own in cells.groupby("engine", sort=False)
    ]
