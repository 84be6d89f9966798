"""Checkpoints as files: hidden, beside the result, one for each process of a run.

The name of a file says which run it is of, at which sample, and of which process. A set of files is
complete when every process of the run has one; an older set is removed only after that, so that
whenever a run is killed, a complete one is left. Each file is numpy's .npz, without pickles,
followed by the SHA-256 of all before in hexadecimal.
"""

from __future__ import annotations

import hashlib
import io
import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from cases.arrays import arrays, fill
from cases.errors import SceneError
from compare.keeping.signature import Signature, differences
from compare.output import write
from compare.processes import Processes

DIGEST = 64  # characters of a SHA-256
ABOUT = "about"  # the array that holds the signature
ANEW = "remove it, or run without --resume"


class Name(NamedTuple):
    """What the name of a checkpoint says."""

    path: Path
    run: str
    samples: int
    rank: int


class Checkpoints:
    """The checkpoints of one run, shared by the processes that make it.

    result : the file of its result.
    """

    def __init__(self, result: Path, signature: Signature, processes: Processes) -> None:
        self.result, self.signature, self.processes = result, signature, processes
        text = json.dumps(signature, sort_keys=True)
        self.run = hashlib.sha256(text.encode()).hexdigest()[:12]

    def newest(self) -> int:
        """Return at which sample the newest one is; 0 where there is none.

        Raises SceneError where it is damaged, or where there are only those of another run.
        """
        samples = self.processes.told_by_first(self._newest)
        if samples:
            self.processes.together(lambda: _read(self._path(samples)))
        return samples

    def load(self, samples: int, parts: Any) -> None:
        """Fill the arrays of `parts` with what they were; raises SceneError where they differ."""
        path = self._path(samples)

        def read() -> None:
            values = [values for name, values in _read(path).items() if name != ABOUT]
            if [_kind(a) for a in values] != [_kind(a) for a in arrays(parts)]:
                raise SceneError(str(path), "", None, f"does not fit this run: {ANEW}")
            fill(parts, values)

        self.processes.together(read)

    def save(self, samples: int, parts: Any) -> None:
        """Write what a run has got to, then remove all older ones.

        Raises OSError, on all processes, where any of them cannot write; the older ones then stay.
        """
        path, text = self._path(samples), json.dumps(self.signature)
        held = {ABOUT: np.array(text)} | {f"{i:05d}": a for i, a in enumerate(arrays(parts))}
        try:
            self.processes.together(lambda: write(path, lambda place: _write(place, held)))
        except OSError:
            path.unlink(missing_ok=True)
            raise
        self.processes.by_first(lambda: self._remove_but(samples))

    def remove(self) -> None:
        """Remove all checkpoints of this result; called on one process."""
        self._remove_but(0)

    def _path(self, samples: int) -> Path:
        stem, rank = self.result.stem, self.processes.rank
        return self.result.with_name(f".{stem}.checkpoint-{self.run}-{samples}-{rank}.npz")

    def _found(self) -> Iterator[Name]:
        """Yield the checkpoints of this result, whichever run they are of."""
        pattern = re.compile(
            rf"\.{re.escape(self.result.stem)}\.checkpoint-([0-9a-f]+)-(\d+)-(\d+)\.npz"
        )
        for path in self.result.parent.glob(".*.npz"):
            if match := pattern.fullmatch(path.name):
                yield Name(path, match[1], int(match[2]), int(match[3]))

    def _newest(self) -> int:
        ranks: dict[int, set[int]] = {}
        others = []
        for name in self._found():
            if name.run == self.run:
                ranks.setdefault(name.samples, set()).add(name.rank)
            else:
                others.append(name.path)
        whole = set(range(self.processes.size))
        found = max((n for n, there in ranks.items() if there == whole), default=0)
        if not found and others:
            self._refuse(others[0])
        return found

    def _refuse(self, other: Path) -> None:
        """Raise SceneError that says how another run differs."""
        differing = differences(self.signature, json.loads(str(_read(other)[ABOUT])))
        raise SceneError(str(other), "", None, f"is of another {', '.join(differing)}: {ANEW}")

    def _remove_but(self, samples: int) -> None:
        for name in self._found():
            if (name.run, name.samples) != (self.run, samples):
                name.path.unlink(missing_ok=True)


def _write(place: Path, held: dict[str, np.ndarray]) -> None:
    whole = io.BytesIO()  # numpy complains of its own file when the disk is full
    np.savez(whole, **held)
    with place.open("wb") as file:
        file.write(whole.getbuffer())
        file.write(hashlib.sha256(whole.getbuffer()).hexdigest().encode())


def _read(path: Path) -> dict[str, np.ndarray]:
    """Return the arrays of a file, in their order; raises SceneError where it is damaged."""
    data = path.read_bytes()
    body, digest = data[:-DIGEST], data[-DIGEST:]
    if hashlib.sha256(body).hexdigest().encode() != digest:
        raise SceneError(str(path), "", None, f"is damaged (its SHA-256 differs): {ANEW}")
    with np.load(io.BytesIO(body), allow_pickle=False) as held:
        return dict(held)


def _kind(array: np.ndarray) -> tuple:
    return array.dtype.str, array.shape
