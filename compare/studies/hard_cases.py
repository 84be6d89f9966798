"""The study of hard cases: the scenes of cases/hard on every engine by every scheme of time steps.

A run holds if it ends as it should, its energy ledger closes, what it dissipates never returns, and
it is no further from the exact solution than its scene expects.

Energy: leapfrog conserves its ledger where joints are linear, to LINEAR; else, where a joint opens
within a step the trapezoid of its force is off by K (v dt)^2 / 8 at most, at a twentieth of the
critical step 3e-4 of m v^2 / 2, OPENING; implicit steps damp on purpose, so that only their
dissipation is bounded. Dissipated energy falls by round-off of each step, STEP times their number.
Misfit: what [expect] allows is for explicit steps; an implicit one has a relative error of the
frequency (omega dt)^2 / 6 more, the phase (omega dt)^2 omega t / 6 at the end of a run, averaged
over the spectrum of a Ricker wavelet (CUBES). Steps above the critical one are refused, and stopped
by the divergence monitor if the scene allows them.
"""

from math import inf, isfinite, nan, pi
from pathlib import Path
from time import perf_counter
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
import xarray as xr

from jointwave import cases
from jointwave.cases.effects import active_effects
from jointwave.cases.errors import SceneError, UnstableError
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.schema.pulse import shortest_period
from jointwave.compare.engines import ENGINES, Progress, applies, solve, solver
from jointwave.compare.figures.export import blank, save
from jointwave.compare.misfit.metrics import misfit
from jointwave.compare.scenes import find, names
from jointwave.compare.studies import store
from jointwave.compare.studies.hard_map import (
    Column,
    StabilityMap,
    columns,
    computed,
    draw_map,
    maps_of,
)
from jointwave.compare.studies.store import Pool, Store
from jointwave.compare.studies.summary import Summary, frame, number, text_table, write_tables
from jointwave.results.dataset import energy_residual, scene_hash

NAME = "stability"
TITLE = "Hard cases for both engines, and the margin by which they hold"
NOTE = (
    "Stable and unstable cells as computed, under the theoretical limit. The table has every hard "
    "case on every engine and scheme: the imbalance of its energy ledger and the largest decrease "
    "of what it has dissipated, over the work, its misfit, and the least bound over its value."
)
COLUMNS = ["engine and scheme", "ends", "energy", "decrease", "misfit", "margin", ""]
STABLE, REFUSED, STOPPED, NONE = "stable", "refused", "stopped", "does not apply"
LINEAR, OPENING, STEP = 1e-10, 1e-3, 1e-15  # bounds on energy, of the work
CUBES = 2.22  # root mean square of f^3 over the spectrum f^2 exp(-f^2) with its peak at f = 1
NONLINEAR = {"slip", "softening", "no tension", "closure"}
SPENT = ("viscous", "friction", "fracture")
#: Changes of steps above the critical one, of a blow in which all modes of the pillar ring.
ABOVE = {"load.period": 1e-3, "time.duration": 2.0, "record.interval": 1.0}
CRITICAL, ALLOW = "step_fraction", "allow_unstable"  # of the engine's table in [numerics]


class HardCase(NamedTuple):
    """A case on one engine by one scheme.

    scene, variant : of a shipped file. changes : dotted keys of the engine's numerics, and of the
    scene. state : how its run should end.
    """

    scene: str
    variant: str
    engine: str
    scheme: str
    changes: dict[str, Any] = {}  # noqa: RUF012
    numerics: dict[str, Any] = {}  # noqa: RUF012
    state: str = STABLE

    @property
    def title(self) -> str:
        """Its scene, variant and step, as the table has them."""
        step = ""
        if self.state != STABLE:
            step = f"{self.numerics[CRITICAL]:g} of the critical step"
            step += ", allowed" * (self.state == STOPPED)
        return ", ".join(filter(None, [self.scene.partition("/")[2], self.variant, step]))

    def read(self) -> AnyScene:
        """Return the scene that is run."""
        numerics: dict[str, Any] = dict(self.numerics)
        if self.scheme != "leapfrog":  # the only one of rigid blocks in the plane
            numerics["scheme"] = self.scheme
        table = f"numerics.{ENGINES[self.engine].engine}"
        keys = {f"{table}.{key}": value for key, value in numerics.items()}
        return cases.load_variant(find(self.scene), self.variant, self.changes | keys)


class HardRow(NamedTuple):
    """What a case has come to; nan where nothing is bounded.

    ended, should : how the run ended, and how it should. energy : imbalance of the ledger, and
    fall : largest decrease of dissipated energy, both over the work. misfit : from `reference`.
    """

    case: str
    engine: str
    scheme: str
    ended: str
    should: str
    steps: float = nan
    energy: float = nan
    energy_bound: float = nan
    fall: float = nan
    fall_bound: float = nan
    misfit: float = nan
    misfit_bound: float = nan
    reference: str = ""
    message: str = ""
    seconds: float = nan

    @property
    def bounded(self) -> list[tuple[float, float]]:
        """Values and bounds of what is bounded."""
        pairs = (self.energy, self.energy_bound), (self.fall, self.fall_bound)
        found = [*pairs, (self.misfit, self.misfit_bound)]
        return [(value, bound) for value, bound in found if isfinite(bound)]

    @property
    def margin(self) -> float:
        """The least bound over its value; infinite without."""
        return min((bound / value if value else inf for value, bound in self.bounded), default=inf)

    @property
    def holds(self) -> bool:
        """Whether it ended as it should, within all bounds: nan is within none."""
        within = all(value <= bound for value, bound in self.bounded)
        return self.ended in (self.should, NONE) and within


def hard_cases() -> list[HardCase]:
    """Return every case: each variant of each scene of cases/hard, and steps above the critical."""
    found = []
    for name in names():
        if not name.startswith("hard/"):
            continue
        for scene in cases.load(find(name)):
            found += [HardCase(name, scene.name, *one) for one in _schemes(scene.kind)]
    above = {CRITICAL: 1.001}
    for engine, scheme in _schemes("pillar"):
        if scheme != "implicit":
            short = HardCase("hard/short-pillar", "", engine, scheme, ABOVE, above, REFUSED)
            found += [short, short._replace(numerics=above | {ALLOW: True}, state=STOPPED)]
    return found


def _schemes(kind: str) -> list[tuple[str, str]]:
    """Return engines with their schemes; rock masses are run by explicit steps alone."""
    explicit = ("leapfrog", "explicit")
    return [
        (engine.name, scheme)
        for engine in ENGINES.values()
        for scheme in engine.schemes
        if kind == "pillar" or scheme in explicit
    ]


def row_of(case: HardCase) -> HardRow:
    """Return the row of a case; all errors of a run are states of it."""
    began = perf_counter()
    row = HardRow(case.title, case.engine, case.scheme, STABLE, case.state)
    try:
        scene = case.read()
        if reason := applies(case.engine, scene).reason:
            return row._replace(ended=NONE, message=reason)
        result = solve(case.engine, scene)
    except UnstableError as error:
        row = row._replace(ended=STOPPED, message=str(error).partition(": ")[2])
    except SceneError as error:
        ended = NONE if error.key.endswith(".scheme") else REFUSED
        row = row._replace(ended=ended, message=error.allowed)
    else:
        row = _measured(row, scene, result)
    return row._replace(seconds=perf_counter() - began)


def _measured(row: HardRow, scene: AnyScene, result: xr.Dataset) -> HardRow:
    steps = float(result.attrs["steps"])
    row = row._replace(steps=steps)
    if "energy" in result:
        row = row._replace(fall=largest_fall(result), fall_bound=STEP * steps)
        if row.scheme != "implicit":
            conserves = row.scheme != "fourth-order" and NONLINEAR.isdisjoint(active_effects(scene))
            bound = LINEAR if conserves else OPENING
            row = row._replace(energy=energy_residual(result), energy_bound=bound)
    for pair, bound in scene.expect.items():
        first, other = pair.split(" ~ ")
        if first == row.engine and solver(other).exact and applies(other, scene):
            found = misfit(result, solve(other, scene))
            more = _implicit_error(scene, steps) if row.scheme == "implicit" else 0.0
            return row._replace(misfit=found, misfit_bound=bound + more, reference=other)
    return row


def _implicit_error(scene: AnyScene, steps: float) -> float:
    """Return the misfit due to implicit steps at the end of a run; nan for a jump, which has no
    shortest period."""
    period = shortest_period(scene.pulses) or nan
    omega, dt = 2 * pi / period, scene.time.duration / steps
    return (omega * dt) ** 2 / 6 * CUBES * omega * scene.time.duration


def largest_fall(result: xr.Dataset) -> float:
    """Return the largest decrease of dissipated energy over the largest work.

    The viscous term alone may fall: where a joint slides, a dashpot whose spring unloads pushes the
    slide on, at the cost of friction.
    """
    energy, terms = result["energy"].values, [str(t) for t in result["term"].values]
    work = float(np.abs(energy[terms.index("work")]).max())
    spent = {t: energy[terms.index(t)] for t in SPENT if t in terms}
    rows = [sum(spent.values()), *(row for t, row in spent.items() if t != "viscous")]
    falls = [float((np.maximum.accumulate(row) - row).max()) for row in rows if np.ndim(row)]
    return max(falls, default=0.0) / work if work else 0.0


def key(case: HardCase) -> str:
    """Return the key of a row: everything that determines it."""
    scene = cases.load_variant(find(case.scene), case.variant)
    return store.key(case._asdict(), scene_hash(scene))


def make_study(out: Path, pool: Pool | None = None, progress: Progress | None = None) -> Summary:
    """Run all cases and the maps, saved in OUT/stability/; write their tables and figure into
    `out`."""
    folder = out / NAME
    cells = Store[Column](Column, folder).compute(columns(), store.key, computed, pool)
    rows = Store[HardRow](HardRow, folder).compute(hard_cases(), key, row_of, pool, progress)
    maps = maps_of(cells)
    with blank(3.6) as figure:
        axes = figure.subplots(1, len(maps), squeeze=False, sharey=True)[0]
        for k, (ax, one) in enumerate(zip(axes, maps, strict=True)):
            draw_map(ax, one, k)
        axes[0].set_ylabel("step over undamped critical step")
    drawn = save(figure, out, NAME, TITLE)
    files = write_tables(out, NAME, frame(rows, HardRow))
    files += write_tables(out, f"{NAME}-map", pd.concat(one.cells for one in maps))
    said = sentences(rows, maps)
    failed = [
        f"{r.case}, {r.engine}, {r.scheme}: {r.ended} {r.message}" for r in rows if not r.holds
    ]
    facts = {"rows": rows, "sentences": said, "files": list(map(str, files))}
    files.append(drawn.file("svg"))
    about = table(rows), said, failed, files, facts, drawn
    return Summary(NAME, TITLE, *about, about=NOTE)


def table(rows: list[HardRow]) -> pd.DataFrame:
    """Return the rows under headings of their case."""
    return text_table(COLUMNS, ((row.case, _cells(row)) for row in rows))


def _cells(row: HardRow) -> list[str]:
    values = [number(x, ".2g") for x in (row.energy, row.fall, row.misfit)]
    margin = number(row.margin, ".3g", "all" if row.bounded else "")
    said = row.message or f"misfit from {row.reference}" * bool(row.reference)
    failed = "" if row.holds else "failed: "
    return [f"{row.engine}, {row.scheme}", row.ended, *values, margin, f"{failed}{said}"]


def sentences(rows: list[HardRow], maps: list[StabilityMap]) -> list[str]:
    """Return the number of rows that hold, the least margin, and cells that contradict theory."""
    asked = [row for row in rows if row.ended != NONE]
    held = [row for row in asked if row.holds]
    found = [
        f"{len(held)} of {len(asked)} rows hold; {len(rows) - len(asked)} do not apply, each with "
        "its reason."
    ]
    if least := min((row for row in held if row.bounded), key=lambda row: row.margin, default=None):
        where = f"{least.case}, {least.engine}, {least.scheme}"
        found.append(f"The least margin is {least.margin:.3g}: {where}.")
    return found + [
        f"{m.engine}: {m.stable.size:,} cells, {int(m.wrong.sum())} on the wrong side of the line, "
        f"{int(m.far.sum())} of them beyond one cell of it."
        for m in maps
    ]
