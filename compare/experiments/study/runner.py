"""How a study is run: every point once, kept as soon as it is done, on any executor."""

import hashlib
import json
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, as_completed
from contextlib import contextmanager, nullcontext
from pathlib import Path
from tempfile import gettempdir

from compare.engines import Progress
from compare.experiments.cost import timings
from compare.experiments.study.measure import Row, measure
from compare.experiments.study.pareto import judged
from compare.experiments.study.study import Point, Study
from compare.runs.checkpoint.lock import exclusive
from compare.runs.checkpoint.signature import program
from compare.runs.output import read_kept, write_text

Pool = Callable[[], Executor]


def run(
    study: Study, folder: Path, pool: Pool | None = None, progress: Progress | None = None
) -> list[Row]:
    """Return the rows of all points of a study, in its order.

    Each is kept in `folder` as soon as it is done, and taken from there when the study is run
    again. Points of a timed study are run one at a time in this process, whatever `pool` is, and
    no two timed studies of a machine at once.

    pool : makes the standard Executor that maps the points: processes of this machine, or
        mpi4py.futures.MPIPoolExecutor of a cluster. None: one after the other.
    """
    points = study.points()
    places = [_place(point, folder) for point in points]
    missing = [i for i, place in enumerate(places) if not place.is_file()]
    done = len(points) - len(missing)
    waits = alone() if study.timed else nullcontext()
    with waits, timings.timing(rate(study), len(missing)):
        for i, row in _measured(points, missing, None if study.timed else pool):
            write_text(places[i], json.dumps(row._asdict(), indent=1))
            done += 1
            if progress:
                progress(done / len(points))
    return judged([read_kept(place, Row) for place in places])


def rate(study: Study) -> str:
    """Return what the seconds of a study's points are remembered by."""
    return f"point of {study.title}"


def is_kept(point: Point, folder: Path) -> bool:
    """Return whether a point is done."""
    return _place(point, folder).is_file()


def _place(point: Point, folder: Path) -> Path:
    return folder / f"{key(point)}.json"


def _measured(points: list[Point], wanted: list[int], pool: Pool | None) -> Iterator:
    """Yield (number, row) of wanted points as they are done."""
    if pool is None:
        for i in wanted:
            yield i, measure(points[i])
        return
    with pool() as executor:
        futures = {executor.submit(measure, points[i]): i for i in wanted}
        for future in as_completed(futures):
            yield futures[future], future.result()


def key(point: Point) -> str:
    """Return what tells points apart: everything that decides a row, this program included."""
    study = point.study.model_copy(update={"title": "", "curves": ()})
    about = [study.model_dump(mode="json", exclude={"curves"}), point.curve.model_dump(mode="json")]
    text = json.dumps([*about, point.settings, program()], sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:16]


@contextmanager
def alone() -> Iterator[None]:
    """Wait until no other timed study is running on this machine."""
    with exclusive(Path(gettempdir()), wait=True):
        yield
