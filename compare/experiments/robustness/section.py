"""The battery's section of the report: the maps, the energies, and every row with its margin."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

from compare.engines import Progress
from compare.experiments.robustness.case import EQUIVALENT, JOINTED, LEAPFROG, Trial
from compare.experiments.robustness.criteria.energies import Drift, drift
from compare.experiments.robustness.diagram import draw
from compare.experiments.robustness.linear_cases import MILLION
from compare.experiments.robustness.map import StabilityMap
from compare.experiments.robustness.row import Row
from compare.experiments.robustness.run import Pool, run, run_maps
from compare.experiments.robustness.table import (
    failures,
    map_sentences,
    summary,
    table,
    write_maps,
    write_rows,
)
from compare.experiments.study.section import StudySection
from compare.figures.export import Drawn, save

NAME = "stability"
TITLE = "Hard cases: what both engines are put to, and by what margin they hold"
NOTE = (
    "Above: stable and unstable cells as computed, under the line that theory draws. Below: "
    "kinetic and elastic energy of undamped pillars over a million steps. The table has every hard "
    "case on every engine and scheme; its margin is the bound over the value."
)


class Found(NamedTuple):
    """All that the study has found, and its files."""

    rows: list[Row]
    maps: list[StabilityMap]
    figure: Drawn
    files: list[Path]


def make_study(
    out: Path, pool: Pool | None = None, slow: bool = True, progress: Progress | None = None
) -> Found:
    """Run the battery, the maps and the long runs; write their tables and figure into `out`.

    Rows and maps that are done are kept in OUT/stability/ and not run again.
    pool : makes the standard Executor that maps the rows; slow : also the rows that take long.
    """
    rows = run(pool, slow, progress, out / NAME)
    maps = run_maps(pool, out / NAME)
    figure = save(draw(maps, drifts()), out, NAME, TITLE)
    files = [write_rows(out / f"{NAME}.csv", rows), write_maps(out / f"{NAME}-map.csv", maps)]
    return Found(rows, maps, figure, [*files, out / f"{NAME}.svg"])


def drifts() -> dict[str, Drift]:
    """Return the energies over a million steps of the solvers that leapfrog's energy holds for."""
    solvers = LEAPFROG, JOINTED, EQUIVALENT
    return {s.name: drift(Trial(MILLION, s), 1_000_000) for s in solvers}


def make_section(
    out: Path, pool: Pool | None = None, slow: bool = False, progress: Progress | None = None
) -> StudySection:
    """Return the section of the page, in the form of all studies; files go to OUT/studies."""
    found = make_study(out / "studies", pool, slow, progress)
    said = summary(found.rows) + map_sentences(found.maps)
    return StudySection(
        NAME, TITLE, NOTE, "", False, found.figure, said, table(found.rows), failures(found.rows)
    )
