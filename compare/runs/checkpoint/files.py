"""Checkpoints as files: hidden, beside the result, one for each process of a run.

The file name contains the run, the sample and the process. A set of files is complete when every
process of the run has one; an older set is removed only after that, so that a killed run always
leaves a complete set. Each file is numpy's .npz, without pickles, followed by the SHA-256 of its
contents in hexadecimal.
"""

import hashlib
import io
import json
import os
import re
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from math import prod
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from jointwave.cases.errors import SceneError
from jointwave.cases.size import require, within
from jointwave.compare.runs.checkpoint.signature import Signature, differences
from jointwave.compare.runs.output import write
from jointwave.compare.runs.processes import Processes
from jointwave.results.arrays import arrays, fill

DIGEST = 64  # characters of a SHA-256
COPIES = 2  # of a file: its arrays, and one of them as bytes
BUFFER = 1 << 20  # bytes
DIRECTORY = 50_000_000  # bytes, of the zip's own directory in memory
ABOUT = "about"  # the array that holds the signature
ANEW = "remove it, or run without --resume"


class Name(NamedTuple):
    """The parts of a checkpoint's file name."""

    path: Path
    run: str
    samples: int
    rank: int


class Checkpoints:
    """The checkpoints of one run, shared by its processes.

    result : the file of its result.
    """

    def __init__(self, result: Path, signature: Signature, processes: Processes) -> None:
        self.result, self.signature, self.processes = result, signature, processes
        text = json.dumps(signature, sort_keys=True)
        self.run = hashlib.sha256(text.encode()).hexdigest()[:12]

    def newest(self) -> int:
        """Return the sample of the newest checkpoint, 0 without one.

        Raises SceneError if it is damaged, or if all checkpoints belong to another run.
        """
        samples = self.processes.told_by_first(self._newest)
        if samples:
            self.processes.together(lambda: _check(self._path(samples)))
        return samples

    def load(self, samples: int, parts: Any) -> None:
        """Fill the arrays of `parts` from a checkpoint; raises SceneError if shapes differ."""
        path = self._path(samples)

        def read() -> None:
            values = [values for name, values in _read(path).items() if name != ABOUT]
            if [_kind(a) for a in values] != [_kind(a) for a in arrays(parts)]:
                raise SceneError(str(path), "", None, f"does not fit this run: {ANEW}")
            fill(parts, values)

        self.processes.together(read)

    def save(self, samples: int, parts: Any) -> None:
        """Write a checkpoint, then remove all older ones.

        Raises OSError, on all processes, if any of them cannot write; the older ones are then kept.
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
        """Yield the checkpoints of this result, of any run."""
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
        """Raise SceneError with the differences from another run."""
        with _as_damage(other):
            signature: Signature = dict(json.loads(str(_read(other)[ABOUT])))
        differing = differences(self.signature, signature) or ["run"]
        raise SceneError(str(other), "", None, f"is from another {', '.join(differing)}: {ANEW}")

    def _remove_but(self, samples: int) -> None:
        for name in self._found():
            if (name.run, name.samples) != (self.run, samples):
                name.path.unlink(missing_ok=True)


def _write(place: Path, held: dict[str, np.ndarray]) -> None:
    whole = io.BytesIO()  # numpy reports errors of its own if the disk is full
    np.savez(whole, **held)
    with place.open("wb") as file:
        file.write(whole.getbuffer())
        file.write(hashlib.sha256(whole.getbuffer()).hexdigest().encode())


def _read(path: Path) -> dict[str, np.ndarray]:
    """Return the arrays of a file, in their order; raises SceneError if it is damaged."""
    size = _check(path)
    with _as_damage(path), within(COPIES * size + DIRECTORY), zipfile.ZipFile(path) as whole:
        members = whole.infolist()
        if sum(member.file_size for member in members) > size:
            raise ValueError("is truncated")
        return {m.filename.removesuffix(".npy"): _array(whole, m) for m in members}


def _check(path: Path) -> int:
    """Return the size of a file (bytes), checked without loading it.

    Raises SceneError if it is damaged, MemoryError if it is too large for the memory.
    """
    with path.open("rb") as file:
        size = os.fstat(file.fileno()).st_size
        require(COPIES * size, str(path))
        digest, left = hashlib.sha256(), max(size - DIGEST, 0)
        while left and (part := file.read(min(left, BUFFER))):
            digest.update(part)
            left -= len(part)
        if digest.hexdigest().encode() != file.read():
            raise SceneError(str(path), "", None, f"is damaged (its SHA-256 differs): {ANEW}")
        return size


def _array(whole: zipfile.ZipFile, member: zipfile.ZipInfo) -> np.ndarray:
    """Return an array of a file; raises ValueError if it is not in the format of `_write`.

    Members are uncompressed and have the size of their array, so none is larger than the file.
    """
    if member.compress_type != zipfile.ZIP_STORED or member.file_size != member.compress_size:
        raise ValueError("is compressed")
    with whole.open(member) as file:
        if np.lib.format.read_magic(file) != (1, 0):
            raise ValueError("is from another version")
        shape, by_columns, kind = np.lib.format.read_array_header_1_0(file)
        if kind.hasobject or file.tell() + kind.itemsize * prod(shape) != member.file_size:
            raise ValueError("has the wrong length")
        return np.frombuffer(file.read(), kind).reshape(shape, order="F" if by_columns else "C")


@contextmanager
def _as_damage(path: Path) -> Iterator[None]:
    """Turn any error from a file's content into one line: its digest may match nonetheless."""
    try:
        yield
    except (SceneError, OSError, MemoryError):
        raise
    except Exception:
        raise SceneError(str(path), "", None, f"is not a checkpoint: {ANEW}") from None


def _kind(array: np.ndarray) -> tuple:
    return array.dtype.str, array.shape
