"""Timing of whole processes in turn: misfits, stepping rates, and time ratios by round."""

import json
import os
import platform
import subprocess
from statistics import median
from time import perf_counter
from typing import NamedTuple

import numpy as np
import pandas as pd
from job import Job, environment_of

from jointwave.compare.misfit.metrics import relative_l2
from jointwave.compare.runs.timings import processor

FINEST = "jointed-bar"  # intact rock with every joint resolved
LONGEST = 600  # s
#: Columns taken from a job, and all columns of the table.
ABOUT = ("curve", "solves", "settings", "reference", "freedoms", "steps")
COLUMNS = (
    *(*ABOUT, "state", "message", "misfit", "total_misfit", "seconds", "whole", "rate", "beside"),
    *("stepping_over_ours", "stepping_over_ours_least", "stepping_over_ours_most"),
    *("whole_over_ours", "whole_over_ours_least", "whole_over_ours_most", "machine"),
)


class Turn(NamedTuple):
    """One run: its waveform, seconds of stepping and of the whole process, or its failure."""

    stress: np.ndarray
    stepping: float = np.nan
    whole: float = np.nan
    failure: str = ""


def on_one_core() -> None:
    """Pin this process and its children to one core, if the system supports it."""
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})


def run(job: Job) -> Turn:
    """Run a job once."""
    began = perf_counter()
    with (job.folder / "output.txt").open("w") as output:
        try:
            done = subprocess.run(
                job.command,
                cwd=job.folder,
                env=environment_of(job),
                stdout=output,
                stderr=subprocess.STDOUT,
                stdin=subprocess.DEVNULL,
                timeout=LONGEST,
            )
        except (OSError, subprocess.TimeoutExpired) as error:
            return Turn(np.zeros(0), failure=str(error))
    whole = perf_counter() - began
    return _failed(job, done.returncode) if done.returncode else _read(job, whole)


def _failed(job: Job, code: int) -> Turn:
    lines = (job.folder / "output.txt").read_text(errors="replace").split("\n")
    said = [line.strip() for line in lines if line.strip(" ^\t")]
    errors = [line for line in said if line.startswith("ERROR")] or said[-1:]
    return Turn(np.zeros(0), failure=f"exit {code}: {errors[0] if errors else 'no output'}")


def _read(job: Job, whole: float) -> Turn:
    try:
        found = job.read(job.folder)
    except (OSError, ValueError, KeyError) as error:
        return Turn(np.zeros(0), failure=f"no waveform: {error}")
    if found.stress.shape != (job.samples,) or not np.isfinite(found.stress).all():
        return Turn(np.zeros(0), failure=f"not {job.samples} finite samples")
    return Turn(found.stress, found.stepping, whole)


def take_turns(jobs: list[Job], rounds: int) -> list[list[Turn]]:
    """Run all jobs once, untimed, then all in every round; return the turns of each job.

    The first run compiles and fills caches. A job that fails then is not run again.
    """
    first = [run(job) for job in jobs]
    turns: list[list[Turn]] = [[turn] if turn.failure else [] for turn in first]
    for _ in range(rounds):
        for job, taken in zip(jobs, turns, strict=True):
            if not (taken and taken[0].failure):
                taken.append(run(job))
    return turns


def row(job: Job, turns: list[Turn], exact: dict[str, np.ndarray]) -> dict:
    """Return a job's row of the table."""
    failure = next((turn.failure for turn in turns if turn.failure), "")
    about = {name: getattr(job, name) for name in ABOUT}
    found = {**about, "state": "failed" if failure else "done", "message": failure}
    if failure:
        return found
    seconds = median(turn.stepping for turn in turns)
    return {
        **found,
        "misfit": relative_l2(turns[-1].stress, exact[job.reference]),
        "total_misfit": relative_l2(turns[-1].stress, exact[FINEST]),
        "seconds": seconds,
        "whole": median(turn.whole for turn in turns),
        "rate": job.freedoms * job.steps / seconds,
    }


def ratios(peer: list[Turn], ours: list[Turn]) -> dict:
    """Return the peer's seconds over ours by round, stepping and whole: median, least, most."""
    if any(turn.failure for turn in (*peer, *ours)):
        return {}
    found = {}
    for name in ("stepping", "whole"):
        pairs = zip(peer, ours, strict=True)
        over = [getattr(one, name) / getattr(other, name) for one, other in pairs]
        for kind, value in (("", median(over)), ("_least", min(over)), ("_most", max(over))):
            found[f"{name}_over_ours{kind}"] = value
    return found


def missing_row(curve: str, solves: str, reason: str) -> dict:
    """Return the row of a peer that cannot be started."""
    return {"curve": curve, "solves": solves, "state": "missing", "message": reason}


def frame(rows: list[dict]) -> pd.DataFrame:
    """Return the rows as a table; missing values are empty."""
    cells = [
        {k: json.dumps(v) if isinstance(v, list | dict) else v for k, v in row.items()}
        for row in rows
    ]
    return pd.DataFrame(cells, columns=list(COLUMNS))


def machine() -> str:
    """Return the processor, cores, load and system of this machine as text."""
    load = f", load {os.getloadavg()[0]:.1f}" if hasattr(os, "getloadavg") else ""
    return f"{processor()}, {os.cpu_count()} cores, one used{load}, {platform.platform()}"
