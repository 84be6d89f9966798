"""State of a run before it starts: done already, or the sample at which it resumes."""

import json
from pathlib import Path
from typing import NamedTuple

from cases.kinds import AnyScene
from compare.engines import ENGINES
from compare.runs.checkpoint.files import Checkpoints
from compare.runs.checkpoint.schedule import RunKeeper
from compare.runs.checkpoint.signals import Signals
from compare.runs.checkpoint.signature import Signature, signature
from compare.runs.output import fields_of
from compare.runs.processes import Processes
from results.dataset import Fields

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
