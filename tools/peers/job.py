"""One run of one code: what it solves, how it is started, and how its waveform is read."""

import json
import os
import shutil
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

import numpy as np


class Reading(NamedTuple):
    """What a run wrote: stress [samples] (Pa, compression positive) and seconds of stepping."""

    stress: np.ndarray
    stepping: float


class Twin(NamedTuple):
    """What of ours is measured beside a run: a model at as many steps a sample and elements."""

    model: str
    stride: int
    elements: int = 0


@dataclass(frozen=True, eq=False)
class Job:
    """A run whose input is written, in a folder of its own.

    curve : the code and its method, a line in the diagram. solves : what it takes the pillar for.
    reference : the exact solution of that model. settings : of this point.
    freedoms, steps : how many. twin : what of ours it is held beside, None for ours.
    """

    curve: str
    solves: str
    reference: str
    settings: dict
    freedoms: int
    steps: int
    samples: int
    folder: Path
    command: list[str]
    read: Callable[[Path], Reading]
    twin: Twin | None = None
    environment: dict[str, str] = field(default_factory=dict)


#: Every code gets one thread; the process is pinned to one core besides.
ONE_THREAD = dict.fromkeys(
    ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"), "1"
)


def environment_of(job: Job) -> dict[str, str]:
    """Return the environment that a job runs in."""
    return {**os.environ, **ONE_THREAD, **job.environment}


def folder_of(root: Path, curve: str, **settings: object) -> Path:
    """Make and return the folder of one point, empty: no older output is taken for a new one."""
    text = "-".join(f"{key}-{value}" for key, value in settings.items())
    folder = root / curve.replace(" ", "-").replace(",", "") / text
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    return folder


def read_driven(folder: Path) -> Reading:
    """Read what our drivers of other codes write: stress.txt and seconds.json."""
    seconds = json.loads((folder / "seconds.json").read_text())
    return Reading(np.loadtxt(folder / "stress.txt"), seconds["stepping"])
