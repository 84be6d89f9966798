"""The one store of experiments: each point is computed once, on any executor, and saved when done.

A point is saved as a JSON file whose name is a hash of everything that determines its result,
including the program. An interrupted experiment thus resumes, and a changed one starts afresh.
"""

import hashlib
import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Generic, TypeVar

import numpy as np

from compare.engines import Progress
from compare.experiments.cost import timings
from compare.experiments.pool import Pool
from compare.runs.checkpoint.signature import program
from compare.runs.output import read_kept, write_text

P = TypeVar("P")
T = TypeVar("T")


def key(*about: Any) -> str:
    """Return the key of a point: a hash of its determining data (JSON) and of this program."""
    text = json.dumps([*about, program()], sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def plain(value: Any) -> Any:
    """Return a result in JSON's types: named tuples as objects, arrays and tuples as lists."""
    if hasattr(value, "_asdict"):
        return plain(value._asdict())
    if isinstance(value, dict):
        return {name: plain(part) for name, part in value.items()}
    if isinstance(value, np.ndarray):
        return value.tolist()
    return [plain(part) for part in value] if isinstance(value, list | tuple) else value


def finite(value: Any) -> Any:
    """Return `plain` with null for NaN and infinity, which JSON does not have."""
    return json.loads(json.dumps(plain(value)), parse_constant=lambda _: None)


@dataclass(frozen=True)
class Store(Generic[T]):
    """The results of an experiment's points.

    form : the type of a result: a NamedTuple, or a list of them. folder : of the files; None:
    nothing is saved. is_valid : whether a saved result is still valid.
    """

    form: Any
    folder: Path | None
    is_valid: Callable[[T], bool] = lambda result: True

    def file(self, key: str) -> Path | None:
        """Return the file of a point; None if nothing is saved."""
        return None if self.folder is None else self.folder / f"{key}.json"

    def has(self, key: str) -> bool:
        """Return whether a point is done."""
        file = self.file(key)
        return file is not None and file.is_file()

    def read(self, key: str) -> T | None:
        """Return a saved result; None without one, or if it is no longer valid.

        Raises SceneError if its file is damaged.
        """
        file = self.file(key)
        if file is None or not file.is_file():
            return None
        found: T = read_kept(file, self.form)
        return found if self.is_valid(found) else None

    def save(self, key: str, result: T) -> None:
        """Save a result."""
        file = self.file(key)
        if file is not None:
            write_text(file, json.dumps(plain(result), indent=1))

    def compute(
        self,
        points: Sequence[P],
        key: Callable[[P], str],
        work: Callable[[P], T],
        pool: Pool | None = None,
        progress: Progress | None = None,
        rate: str = "",
        lost: T | None = None,
    ) -> list[T]:
        """Return the results of points, in order; saved ones are not recomputed.

        work : returns the result of a point; a pool's processes import it. pool : makes the
        executor; None: sequentially in this process. rate : key of the timings of a point.
        lost : the result of a point whose process has died, not saved; None: an error.
        """
        keys = [key(point) for point in points]
        found = {name: done for name in keys if (done := self.read(name)) is not None}
        missing = {k: point for k, point in zip(keys, points, strict=True) if k not in found}
        count = len(found) + len(missing)
        with timings.timing(rate, len(missing)) if rate else nullcontext():
            for name, result in _results(missing, work, pool, lost):
                found[name] = result
                if result is not lost:
                    self.save(name, result)
                if progress:
                    progress(len(found) / count)
        return [found[name] for name in keys]


def _results(
    points: Mapping[str, P], work: Callable[[P], T], pool: Pool | None, lost: T | None
) -> Iterator[tuple[str, T]]:
    if pool is None or not points:
        for name, point in points.items():
            yield name, work(point)
        return
    with pool() as executor:
        futures = {executor.submit(work, point): name for name, point in points.items()}
        for future in as_completed(futures):
            try:
                yield futures[future], future.result()
            except BrokenProcessPool:
                if lost is None:
                    raise
                yield futures[future], lost
