"""One run of one code: its model, command, and reader of its waveform."""

import json
import os
import shutil
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

import numpy as np


class Reading(NamedTuple):
    """The output of a run: stress [samples], Pa, compression positive, and seconds of stepping."""

    stress: np.ndarray
    stepping: float


class Twin(NamedTuple):
    """The jointwave run compared with a run: a model with equal steps per sample and elements."""

    model: str
    stride: int
    elements: int = 0


@dataclass(frozen=True, eq=False)
class Job:
    """A run with its input, in a separate folder.

    curve : the code and its method, a line in the diagram. solves : its model of the pillar.
    reference : the exact solution of that model. settings : of this point. freedoms, steps : their
    numbers. twin : the jointwave run compared with it, None for jointwave's own runs.
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


#: Every code gets one thread; the process is also pinned to one core.
ONE_THREAD = dict.fromkeys(
    ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"), "1"
)


def environment_of(job: Job) -> dict[str, str]:
    """Return the environment variables of a job."""
    return {**os.environ, **ONE_THREAD, **job.environment}


def folder_of(root: Path, curve: str, **settings: object) -> Path:
    """Create and return the folder of one point, emptied of old output."""
    text = "-".join(f"{key}-{value}" for key, value in settings.items())
    folder = root / curve.replace(" ", "-").replace(",", "") / text
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    return folder


def read_driven(folder: Path) -> Reading:
    """Read the output of a driver of another code: stress.txt and seconds.json."""
    seconds = json.loads((folder / "seconds.json").read_text())
    return Reading(np.loadtxt(folder / "stress.txt"), seconds["stepping"])
