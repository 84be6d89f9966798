"""Run a study: every point once, on any executor; those of a timed study alone."""

from contextlib import nullcontext
from pathlib import Path

from compare.engines import Progress
from compare.experiments import store
from compare.experiments.pool import Pool, alone
from compare.experiments.store import Store
from compare.experiments.study.measure import PointRow, measure
from compare.experiments.study.pareto import judged
from compare.experiments.study.study import Study, StudyPoint


def run(
    study: Study, folder: Path, pool: Pool | None = None, progress: Progress | None = None
) -> list[PointRow]:
    """Return the rows of all points of a study, in its order; they are saved in `folder`.

    Points of a timed study are run one at a time in this process, whatever `pool` is, and no two
    timed studies of a machine at once.
    """
    rows: Store[PointRow] = Store(PointRow, folder)
    with alone() if study.timed else nullcontext():
        pool = None if study.timed else pool
        return judged(rows.compute(study.points(), key, measure, pool, progress, rate(study)))


def rate(study: Study) -> str:
    """Return what the seconds of a study's points are remembered by."""
    return f"point of {study.title}"


def key(point: StudyPoint) -> str:
    """Return what tells points apart: everything that decides a row."""
    study = point.study.model_dump(mode="json", exclude={"title", "curves"})
    return store.key(study, point.curve.model_dump(mode="json"), point.settings)
