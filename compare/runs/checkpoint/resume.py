"""Checkpoints of a run at intervals of wall time, its interruption, its start and continuation."""

import json
import sys
from pathlib import Path
from time import monotonic
from typing import Any, NamedTuple

import xarray as xr

from jointwave.cases.errors import InterruptedRun, printable
from jointwave.cases.sampling import sample_times
from jointwave.cases.scene_type import AnyScene
from jointwave.compare.engines import ENGINES
from jointwave.compare.runs.checkpoint.files import Checkpoints
from jointwave.compare.runs.checkpoint.signals import Signals, exit_code, word
from jointwave.compare.runs.checkpoint.signature import Signature, signature
from jointwave.compare.runs.processes import Processes
from jointwave.results.netcdf import load_netcdf


class RunCheckpointer:
    """Keeps one run, see `numerics.time_loop.Checkpointer`.

    done : number of samples in its newest checkpoint, 0 for a new run.
    every : interval between checkpoints in wall time, s; 0: none.
    processes : that share the run; they decide together, as their clocks and signals differ.
    """

    def __init__(
        self, scene: AnyScene, files: Checkpoints, done: int, every: float, signals: Signals
    ) -> None:
        self.scene, self.files, self.done = scene, files, done
        self.processes: Processes = files.processes
        self.signals, self._every = signals, every
        self._last: float | None = None
        self._warned = False
        self._total = len(sample_times(scene))

    def restore(self, parts: Any) -> None:
        """Restore `parts` from the newest checkpoint, and report it."""
        self.files.load(self.done, parts)
        self._say(f"{self.files.result} continues at t = {self._time(self.done):.4g} s")

    def look(self, samples: int, parts: Any) -> None:
        """Save the parts of a run when due; raises InterruptedRun if a signal is pending."""
        if samples >= self._total:
            self.relax()
            return
        self.signals.patient = True
        asked, due = self.processes.largest((self.signals.asked, self._is_due()))
        if asked:
            self._stop(asked, samples, parts)
        if due:
            self._save(samples, parts)

    def relax(self) -> None:
        """Let signals end the program immediately again; of several processes, the first one."""
        self.signals.patient = not self.processes.is_first

    def _is_due(self) -> bool:
        now = monotonic()
        self._last = now if self._last is None else self._last
        return self._every > 0 and now - self._last >= self._every

    def _save(self, samples: int, parts: Any) -> bool:
        """Write a checkpoint and return whether it succeeded; report the first failure."""
        try:
            self.files.save(samples, parts)
        except OSError as error:
            if not self._warned:
                self._say(f"no checkpoint, {error.filename}: {error.strerror}; the run continues")
            self._warned = True
            return False
        finally:
            self._last = monotonic()
        return True

    def _stop(self, number: int, samples: int, parts: Any) -> None:
        can_go_on = self._every > 0 and self._save(samples, parts)
        message = f"{word(number)} at t = {self._time(samples):.4g} s"
        message += ", --resume continues from there" if can_go_on else ""
        error = InterruptedRun(message)
        error.code = exit_code(number)
        raise error

    def _time(self, samples: int) -> float:
        """Return the time of the last of `samples` samples, s."""
        return (samples - 1) * self.scene.interval

    def _say(self, text: str) -> None:
        if self.processes.is_first:
            print(f"jointwave: {printable(text)}", file=sys.stderr, flush=True)


ATTRIBUTE = "signature"  # of a result: everything that determines its bits, as JSON


class CheckpointSettings(NamedTuple):
    """Checkpoint settings of a command's runs.

    every : interval between checkpoints in wall time, s; 0: none. resume : continue the runs of an
        earlier command. signals : that end a run.
    """

    every: float
    resume: bool
    signals: Signals


class ResumableRun(NamedTuple):
    """One run with its checkpoints.

    is_made : whether its result already exists and need not be recomputed.
    keeper : of its steps; None if it has no steps or no checkpoints are requested.
    """

    signature: Signature
    checkpoints: Checkpoints
    is_made: bool
    keeper: RunCheckpointer | None

    def signed(self, result: xr.Dataset) -> xr.Dataset:
        """Return a result with the signature of everything that determines its bits."""
        return result.assign_attrs({ATTRIBUTE: json.dumps(self.signature)})


def resumable(
    scene: AnyScene,
    name: str,
    path: Path,
    settings: CheckpointSettings | None,
    processes: Processes,
) -> ResumableRun:
    """Return a run with its checkpoints; called on all `processes` that share it.

    name : of the solver. path : of the result.
    Raises SceneError if the checkpoint to continue from is damaged or belongs to another run.
    """
    about = signature(scene, name, processes.size)
    files = Checkpoints(path, about, processes)
    if settings is None:
        return ResumableRun(about, files, False, None)
    is_made = settings.resume and processes.told_by_first(
        lambda: result_of(path, about) is not None
    )
    if is_made or name not in ENGINES:
        return ResumableRun(about, files, is_made, None)
    done = files.newest() if settings.resume else 0
    return ResumableRun(
        about, files, False, RunCheckpointer(scene, files, done, settings.every, settings.signals)
    )


def result_of(path: Path, about: Signature) -> xr.Dataset | None:
    """Return the result with this signature; None if there is none or it cannot be read."""
    if not path.is_file():
        return None
    try:
        found = load_netcdf(path)
    except MemoryError as error:
        raise MemoryError(f"{path}: {error}") from None
    except Exception:  # any unreadable result is recomputed
        return None
    return found if found.attrs.get(ATTRIBUTE) == json.dumps(about) else None
