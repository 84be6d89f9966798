"""Checkpoints as hidden files next to the result, one for each process of a run.

The file name contains the run, the sample and the process. A set of files is complete when every
process of the run has one; only then is the older set removed, so that a killed run always leaves a
complete set. Each file is numpy's .npz, without pickles and with the checksums of zip.
"""

import hashlib
import io
import json
import re
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from jointwave.cases.errors import SceneError
from jointwave.cases.size import require
from jointwave.compare.runs.checkpoint.signature import Signature, differences
from jointwave.compare.runs.output import write
from jointwave.compare.runs.processes import Processes
from jointwave.results.arrays import arrays, fill

COPIES = 2  # memory to read a file, over its size: its arrays, and one of them as bytes
ABOUT = "about"  # the first array, the signature as JSON
ANEW = "remove it, or run without --resume"


class Checkpoints:
    """The checkpoints of one run, shared by its processes.

    result : the file of its result.
    """

    def __init__(self, result: Path, signature: Signature, processes: Processes) -> None:
        self.result, self.signature, self.processes = result, signature, processes
        text = json.dumps(signature, sort_keys=True)
        self.run = hashlib.sha256(text.encode()).hexdigest()[:12]

    def newest(self) -> int:
        """Return the sample of the newest complete checkpoint, 0 if there is none.

        Raises SceneError if it is damaged, or if all checkpoints belong to another run.
        """
        samples = self.processes.told_by_first(self._newest)
        if samples:
            self.processes.together(lambda: _read(self._path(samples)))
        return samples

    def load(self, samples: int, parts: Any) -> None:
        """Fill the arrays of `parts` from a checkpoint; raises SceneError if shapes differ."""
        path = self._path(samples)

        def read() -> None:
            _, *values = _read(path).values()
            kinds = [[(a.dtype.str, a.shape) for a in some] for some in (values, arrays(parts))]
            if kinds[0] != kinds[1]:
                raise SceneError(str(path), "", None, f"does not fit this run: {ANEW}")
            fill(parts, values)

        self.processes.together(read)

    def save(self, samples: int, parts: Any) -> None:
        """Write a checkpoint, then remove all older ones.

        Raises OSError on all processes if any cannot write; older checkpoints are then kept.
        """
        path, content = self._path(samples), io.BytesIO()
        held = {f"{i:05d}": a for i, a in enumerate(arrays(parts))}
        # In memory first: numpy reports a full disk by errors of its own.
        np.savez(content, **{ABOUT: np.array(json.dumps(self.signature))}, **held)
        try:
            self.processes.together(
                lambda: write(path, lambda place: place.write_bytes(content.getvalue()))
            )
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

    def _found(self) -> Iterator[tuple[Path, str, int]]:
        """Yield the checkpoint files of this result with their run and sample."""
        stem = re.escape(self.result.stem)
        pattern = re.compile(rf"\.{stem}\.checkpoint-([0-9a-f]+)-(\d+)-\d+\.npz")
        for path in self.result.parent.glob(".*.npz"):
            if match := pattern.fullmatch(path.name):
                yield path, match[1], int(match[2])

    def _newest(self) -> int:
        found = list(self._found())
        counts = Counter(samples for _, run, samples in found if run == self.run)
        complete = [samples for samples, n in counts.items() if n == self.processes.size]
        others = [path for path, run, _ in found if run != self.run]
        if others and not complete:
            self._refuse(others[0])
        return max(complete, default=0)

    def _refuse(self, other: Path) -> None:
        """Raise SceneError with the differences between this run and that of another file."""
        try:
            signature: Signature = dict(json.loads(str(_read(other)[ABOUT])))
        except (ValueError, TypeError):
            signature = self.signature
        differing = differences(self.signature, signature) or ["run"]
        raise SceneError(str(other), "", None, f"is from another {', '.join(differing)}: {ANEW}")

    def _remove_but(self, samples: int) -> None:
        for path, *of in self._found():
            if of != [self.run, samples]:
                path.unlink(missing_ok=True)


def _read(path: Path) -> dict[str, np.ndarray]:
    """Return the arrays of a file, in their order.

    Raises SceneError if it is damaged, MemoryError if it is too large for the memory.
    """
    size = path.stat().st_size
    require(COPIES * size, str(path))
    try:
        with path.open("rb") as file, np.load(file) as content:
            found = dict(content)
        if next(iter(found), None) != ABOUT:
            raise ValueError("is without a signature")
    except Exception:  # numpy and zipfile raise many kinds
        raise SceneError(str(path), "", None, f"is damaged: {ANEW}") from None
    return found
