"""Checkpoints of a run by the clock, its end on request, and where it begins or goes on."""

import json
import sys
from pathlib import Path
from time import monotonic
from typing import Any, NamedTuple

from cases.errors import InterruptedRun, printable
from cases.kinds import AnyScene
from cases.sampling import sample_times
from compare.engines import ENGINES
from compare.runs.checkpoint.files import Checkpoints
from compare.runs.checkpoint.signals import Signals, exit_code, word
from compare.runs.checkpoint.signature import Signature, signature
from compare.runs.output import fields_of
from compare.runs.processes import Processes
from results.dataset import Fields


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
        self._say(f"{self.files.result} continues at t = {self._time(self.done):.4g} s")

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
                self._say(f"no checkpoint, {error.filename}: {error.strerror}; the run continues")
            self._warned = True
            return False
        finally:
            self._last = monotonic()
        return True

    def _stop(self, number: int, samples: int, parts: Any) -> None:
        can_go_on = self._every > 0 and self._save(samples, parts)
        message = f"{word(number)} at t = {self._time(samples):.4g} s"
        error = Interrupted(f"{message}, --resume continues from there" if can_go_on else message)
        error.code = exit_code(number)
        raise error

    def _time(self, samples: int) -> float:
        """Return the time of the last of so many samples, s."""
        return (samples - 1) * self.scene.interval

    def _say(self, text: str) -> None:
        if self.processes.is_first:
            print(f"jointwave: {printable(text)}", file=sys.stderr, flush=True)


ATTRIBUTE = "signature"  # of a result: as JSON, what decided its bits


class Keeping(NamedTuple):
    """How the runs of a command are kept.

    every : s of wall time from one checkpoint to the next; 0: none. resume : go on where an
        earlier command has stopped. signals : that end a run.
    """

    every: float
    resume: bool
    signals: Signals


class Watch(NamedTuple):
    """One run, watched over.

    is_made : whether its result is there already, and is not to be made again.
    keeper : of its steps; None where it has none, or nobody asks for one.
    """

    signature: Signature
    checkpoints: Checkpoints
    is_made: bool
    keeper: RunKeeper | None

    def signed(self, result: Fields) -> Fields:
        """Return a result that says what decided its bits."""
        about = {ATTRIBUTE: json.dumps(self.signature)}
        return result._replace(attributes={**result.attributes, **about})


def watch(
    scene: AnyScene, name: str, path: Path, keeping: Keeping | None, processes: Processes
) -> Watch:
    """Return a run watched over; on all `processes` that share it.

    name : of what solves the scene. path : of the result.
    Raises SceneError where it is to go on from a checkpoint that is damaged or of another run.
    """
    about = signature(scene, name, processes.size)
    files = Checkpoints(path, about, processes)
    if keeping is None:
        return Watch(about, files, False, None)
    is_made = keeping.resume and processes.told_by_first(lambda: result_of(path, about) is not None)
    if is_made or name not in ENGINES:
        return Watch(about, files, is_made, None)
    done = files.newest() if keeping.resume else 0
    return Watch(about, files, False, RunKeeper(scene, files, done, keeping.every, keeping.signals))


def result_of(path: Path, about: Signature) -> Fields | None:
    """Return a result of this signature; None where there is none that can be read."""
    if not path.is_file():
        return None
    from results.netcdf import load_netcdf

    try:
        found = fields_of(load_netcdf(path))
    except MemoryError as error:
        raise MemoryError(f"{path}: {error}") from None
    except Exception:  # whatever is wrong with it, it will be made again
        return None
    return found if found.attributes.get(ATTRIBUTE) == json.dumps(about) else None
