"""Checkpoints of a run at intervals of wall time, its interruption and continuation."""

import sys
from dataclasses import dataclass, field
from pathlib import Path
from time import monotonic
from typing import Any

import xarray as xr

from jointwave.cases.errors import InterruptedRun, printable
from jointwave.cases.sampling import sample_times
from jointwave.cases.scene_type import AnyScene
from jointwave.compare.engines import ENGINES
from jointwave.compare.runs.checkpoint.files import Checkpoints
from jointwave.compare.runs.checkpoint.signals import WORDS, Ended, Signals
from jointwave.compare.runs.checkpoint.signature import signature
from jointwave.compare.runs.processes import Processes
from jointwave.compare.runs.reuse import read_result, unlike


@dataclass(frozen=True)
class CheckpointSettings:
    """Checkpoint settings of a command's runs.

    every : wall time between checkpoints, s; 0: none. resume : continue the runs of an earlier
        command. signals : those that end a run. fresh : compute everything anew.
    told : the logged reasons why files were not read.
    """

    every: float
    resume: bool
    signals: Signals
    fresh: bool = False
    told: set[str] = field(default_factory=set)


class RunCheckpointer:
    """Saves and restores one run, see `numerics.time_loop.Checkpointer`.

    done : number of samples in its newest checkpoint, 0 for a new run.
    processes : share the run; they decide together, because their clocks and signals differ.
    """

    def __init__(
        self,
        scene: AnyScene,
        solver: str,
        result: Path,
        settings: CheckpointSettings,
        processes: Processes,
    ) -> None:
        """Find a checkpoint to continue from, unless the result exists; called on all `processes`.

        Raises SceneError if the checkpoint is damaged or belongs to another run.
        """
        self.scene, self.settings, self.processes = scene, settings, processes
        self.signature = signature(scene, solver, processes.size)
        self.files = Checkpoints(result, self.signature, processes)
        is_made = processes.told_by_first(lambda: not unlike(result, self.signature))
        resumes = settings.resume and not is_made and solver in ENGINES
        self.done = self.files.newest() if resumes else 0
        self._last: float | None = None
        self._warned = False
        self._total = len(sample_times(scene))

    def restore(self, parts: Any) -> None:
        """Restore `parts` from the newest checkpoint and report the time reached."""
        self.files.load(self.done, parts)
        self._say(f"{self.files.result} continues at t = {self._time(self.done):.4g} s")

    def look(self, samples: int, parts: Any) -> None:
        """Save `parts` when due; raises InterruptedRun if a signal is pending on any process.

        After the last sample a signal to the first process ends the program at once again.
        """
        signals, every = self.settings.signals, self.settings.every
        signals.patient = samples < self._total or not self.processes.is_first
        if samples >= self._total:
            return
        self._last = self._last or monotonic()
        is_due = 0 < every <= monotonic() - self._last
        asked, is_due = max(self.processes.all_of((signals.asked, is_due)))
        saved = (is_due or (asked and every > 0)) and self._save(samples, parts)
        if asked:
            message = f"{WORDS[asked]} at t = {self._time(samples):.4g} s"
            error = InterruptedRun(message + ", --resume continues from there" * bool(saved))
            error.samples, error.code = samples, Ended(asked).code
            raise error

    def finished(self) -> xr.Dataset | None:
        """Return the result of an earlier command, None if it must be computed."""
        if self.settings.fresh:
            return None
        return read_result(self.files.result, self.scene, self.signature, self.settings.told)

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

    def _time(self, samples: int) -> float:
        """Return the time of the last of `samples` samples, s."""
        return (samples - 1) * self.scene.interval

    def _say(self, text: str) -> None:
        if self.processes.is_first:
            print(f"jointwave: {printable(text)}", file=sys.stderr, flush=True)
