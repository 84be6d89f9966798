"""Checkpoints of `jointwave run` by the clock, and its end on request."""

import sys
from time import monotonic
from typing import Any

from cases.errors import InterruptedRun, printable
from cases.kinds import AnyScene
from cases.sampling import sample_times
from compare.runs.checkpoint.files import Checkpoints
from compare.runs.checkpoint.signals import Signals, exit_code, word
from compare.runs.processes import Processes


class Interrupted(InterruptedRun):
    """A run that a signal has stopped.

    code : that the program exits with.
    """

    code: int = 1


class RunKeeper:
    """Keeps one run, see `numerics.checkpoint.Keeper`.

    done : how many samples its newest checkpoint has; 0 where the run starts anew.
    every : s of wall time from one checkpoint to the next; 0: none.
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
        """Copy into `parts` what they were at the newest checkpoint, and say so."""
        self.files.load(self.done, parts)
        self._say(f"{self.files.result} goes on at t = {self._time(self.done):.4g} s")

    def look(self, samples: int, parts: Any) -> None:
        """Keep the parts of a run where it is time to; raises Interrupted where a signal waits."""
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
        """Let signals end the program at once again; where several share it, on the first."""
        self.signals.patient = not self.processes.is_first

    def _is_due(self) -> bool:
        now = monotonic()
        self._last = now if self._last is None else self._last
        return self._every > 0 and now - self._last >= self._every

    def _save(self, samples: int, parts: Any) -> bool:
        """Write a checkpoint, and return whether that went well; say once where it does not."""
        try:
            self.files.save(samples, parts)
        except OSError as error:
            if not self._warned:
                self._say(f"no checkpoint, {error.filename}: {error.strerror}; the run goes on")
            self._warned = True
            return False
        finally:
            self._last = monotonic()
        return True

    def _stop(self, number: int, samples: int, parts: Any) -> None:
        can_go_on = self._every > 0 and self._save(samples, parts)
        message = f"{word(number)} at t = {self._time(samples):.4g} s"
        error = Interrupted(f"{message}, --resume goes on from there" if can_go_on else message)
        error.code = exit_code(number)
        raise error

    def _time(self, samples: int) -> float:
        """Return the time of the last of so many samples, s."""
        return (samples - 1) * self.scene.interval

    def _say(self, text: str) -> None:
        if self.processes.is_first:
            print(f"jointwave: {printable(text)}", file=sys.stderr, flush=True)
