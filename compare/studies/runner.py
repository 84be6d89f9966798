"""How a study is run: every point once, kept as soon as it is done, on any executor."""

import fcntl
import hashlib
import json
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, as_completed
from contextlib import contextmanager, nullcontext
from functools import cache
from pathlib import Path
from tempfile import gettempdir

import cases
from compare.engines import Progress
from compare.output import write_text
from compare.studies.measure import Row, measure
from compare.studies.study import Point, Study

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
    places = [folder / f"{key(point)}.json" for point in points]
    missing = [i for i, place in enumerate(places) if not place.is_file()]
    done = len(points) - len(missing)
    with alone() if study.timed else nullcontext():
        for i, row in _measured(points, missing, None if study.timed else pool):
            write_text(places[i], json.dumps(row._asdict(), indent=1))
            done += 1
            if progress:
                progress(done / len(points))
    return [Row(**json.loads(place.read_text(encoding="utf-8"))) for place in places]


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


@cache
def program() -> str:
    """Return a hash of all that computes."""
    digest, root = hashlib.sha256(), Path(cases.__file__).parent.parent
    for package in ("cases", "joints", "dem", "continuum", "compare"):
        for source in sorted((root / package).rglob("*.py")):
            digest.update(source.read_bytes())
    return digest.hexdigest()


@contextmanager
def alone() -> Iterator[None]:
    """Wait until no other timed study is running on this machine."""
    with Path(gettempdir(), "jointwave-timing.lock").open("a") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        yield
