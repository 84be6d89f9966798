"""Reuse of results of earlier commands.

The signature in a file says what computed it, a checksum whether it is intact.
"""

import hashlib
import json
import logging
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from datetime import datetime
from pathlib import Path

import numpy as np
import xarray as xr

from jointwave.cases.errors import InterruptedRun, SceneError, UnstableError
from jointwave.cases.scene_type import AnyScene
from jointwave.compare.engines import Progress
from jointwave.compare.runs import timings
from jointwave.compare.runs.checkpoint.signature import PROCESSES, Signature, differences, signature
from jointwave.compare.runs.jobs import result_path
from jointwave.compare.runs.output import write_dataset
from jointwave.results.dataset import scene_hash
from jointwave.results.netcdf import load_netcdf

SIGNATURE, CHECKSUM, SECONDS = "signature", "checksum", "seconds_total"  # attributes of a result
SNAPSHOTS = "-snapshots"  # suffix of the files of films and views, which record more
DAMAGED = "is damaged"

log = logging.getLogger("jointwave")


def signed(result: xr.Dataset, about: Signature, seconds: float) -> xr.Dataset:
    """Return a result with the attributes of its file; seconds : its computing time."""
    whole = {CHECKSUM: _checksum(result), SECONDS: seconds}
    return result.assign_attrs({SIGNATURE: json.dumps(about), **whole})


def unlike(path: Path, about: Signature) -> str:
    """Return why a file is not the result of this signature, from its attributes only; "" if it is.

    The number of processes is ignored: it changes a result by round-off only.
    """
    if not path.is_file():
        return "is missing"
    try:
        held = load_netcdf(path, ()).attrs
        other = dict(json.loads(held[SIGNATURE]))
        held[CHECKSUM], float(held[SECONDS])
    except KeyError:
        return "does not say what computed it"
    except Exception:  # the libraries raise many kinds
        return DAMAGED
    differing = [key for key in differences(about, other) if key != PROCESSES]
    return f"is from another {', '.join(differing)}" if differing else ""


def read_result(path: Path, scene: AnyScene, about: Signature, told: set[str]) -> xr.Dataset | None:
    """Return the result of this signature from a file, or None and log why, each reason once.

    scene : replaces the scene in the file, from which it may differ in keys that do not affect the
    result, such as `[expect]`. told : the reasons logged so far.
    """
    found, why = None, unlike(path, about)
    if not why:
        try:
            found = load_netcdf(path)
            why = "" if found.attrs[CHECKSUM] == _checksum(found) else DAMAGED
        except MemoryError as error:
            why = f"needs too much memory to be read: {error}"
        except Exception:
            why = DAMAGED
    if found is None or why:
        if path.is_file() and why not in told:
            log.info("computes %s anew: it %s; others for this reason are not listed", path, why)
            told.add(why)
        return None
    texts = {k: v.astype(str) for k, v in found.variables.items() if v.dtype == object}
    numbers = {k: v.item() for k, v in found.attrs.items() if isinstance(v, np.generic)}
    of_scene = {"scene_hash": scene_hash(scene), "scene": scene.model_dump_json()}
    return found.assign(texts).assign_attrs(numbers | of_scene)


def seconds_read(results: Mapping[str, xr.Dataset]) -> list[float]:
    """Return the computing times, s, of those results that were read from files."""
    return [float(one.attrs[SECONDS]) for one in results.values() if SECONDS in one.attrs]


def log_reading(read: Mapping[Path, xr.Dataset]) -> None:
    """Log which files of a folder were read, when they were computed, and in how many seconds."""
    if read:
        (first, *others), seconds = read, sum(one.attrs[SECONDS] for one in read.values())
        names = ", ".join([str(first), *(path.name for path in others)])
        last = datetime.fromtimestamp(max(path.stat().st_mtime for path in read))
        when = f"{last:%Y-%m-%d %H:%M} in {seconds:.2g} s"
        log.info("reads %s, computed on %s; --fresh computes anew", names, when)


@dataclass(frozen=True)
class ResultFolder:
    """A folder with the results of a scene; None: nothing is read or stored.

    fresh : compute everything anew. told : the logged reasons why files were not read.
    """

    folder: Path | None = None
    fresh: bool = False
    told: set[str] = field(default_factory=set, compare=False)

    def solve(
        self,
        names: Iterable[str],
        scene: AnyScene,
        progress: Progress | None = None,
        suffix: str = "",
        failed: dict[str, Exception] | None = None,
    ) -> Iterator[tuple[str, xr.Dataset]]:
        """Yield the name and result of each solver; computed results are stored.

        suffix : of the file names, if the scene records other quantities than its file. failed :
        collects the errors of `compare.engines.solve` by name, which are logged; None: raise them.
        """
        every, folder, read = list(names), self.folder, {}
        for i, name in enumerate(every):

            def part(fraction: float, i: int = i) -> None:
                if progress:
                    progress((i + fraction) / len(every))

            path = folder and result_path(folder, scene, name, suffix)
            about = signature(scene, name, 1) if path else {}
            found = read_result(path, scene, about, self.told) if path and not self.fresh else None
            if path and found is not None:
                read[path] = result = found
            else:
                log_reading(read)
                read = {}
                try:
                    result, seconds = timings.solved(name, scene, part)
                except (SceneError, UnstableError) as error:
                    if failed is None or isinstance(error, InterruptedRun):
                        raise
                    failed[name] = error
                    log.warning("warning: %s is left out: %s", name, error)
                    continue
                if path and not _is_stored(path, signed(result, about, seconds)):
                    folder = None
            part(1.0)
            yield name, result
        log_reading(read)

    def has(self, name: str, scene: AnyScene, suffix: str = "") -> bool:
        """Return whether a result would be read."""
        if self.folder is None or self.fresh:
            return False
        path = result_path(self.folder, scene, name, suffix)
        return not unlike(path, signature(scene, name, 1))


NOWHERE = ResultFolder()


def _is_stored(path: Path, result: xr.Dataset) -> bool:
    """Write a result and return whether that succeeded; the reason is logged if not."""
    try:
        write_dataset(path, result)
    except (OSError, SceneError, MemoryError) as error:
        place = getattr(error, "filename", None) or path
        log.info("results are not stored: %s: %s", place, getattr(error, "strerror", error))
        return False
    return True


def _checksum(result: xr.Dataset) -> str:
    """Return a checksum of all variables, equal for a result and for its file."""
    digest = hashlib.sha256()
    for name in sorted(map(str, result.variables)):
        values = result.variables[name]
        digest.update(json.dumps([name, values.dims, values.shape]).encode())
        if values.dtype.kind in "OSU":
            digest.update(json.dumps(values.values.astype(str).tolist()).encode())
        else:
            digest.update(np.ascontiguousarray(values.values, "<f8").data)
    return digest.hexdigest()
