"""Memory of a run, estimated before any of it is allocated.

Each engine estimates what its arrays take, from the numbers of blocks, samples and steps alone, by
the key of the scene that decides it. A run is refused where the sum is beyond `memory()`.
"""

import os
import resource
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from functools import cache
from math import isfinite
from pathlib import Path

from jointwave.cases.errors import SceneError
from jointwave.cases.scene_type import AnyScene

LIMIT = "JOINTWAVE_MEMORY"  # GB, in the environment: a bound of the user's own
LARGEST_VARIABLE = 2**31 - 4  # bytes, of a NetCDF 3 file
#: Memory limits of control groups, versions 2 and 1.
GROUPS = ("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes")

#: Bytes a step for the load's mean over it, and what that is made of; its history is table.
LOAD_OF_STEP, TABLE_OF_STEP = 24, 64
LEDGER = 5  # terms of an energy ledger, at least
#: Copies of a waveform in memory: as sampled, and as written.
COPIES = 2


#: Where estimates go meanwhile, for those who only want to know them.
_asked: ContextVar[dict[str, float] | None] = ContextVar("_asked", default=None)


@contextmanager
def estimates() -> Iterator[dict[str, float]]:
    """Collect the memory of the parts of a run (bytes, by the key that decides them) in the
    checks before it."""
    parts: dict[str, float] = {}
    token = _asked.set(parts)
    try:
        yield parts
    finally:
        _asked.reset(token)


def memory() -> float:
    """Return the bytes that a run may use: JOINTWAVE_MEMORY, else the machine's memory."""
    asked = os.environ.get(LIMIT)
    if asked is None:
        return _of_machine()
    try:
        limit = float(asked)
    except ValueError:
        limit = 0.0
    if not (limit > 0 and isfinite(limit)):
        raise SceneError(LIMIT, "", None, f"is {asked!r}, must be a positive number (GB)")
    return 1e9 * limit


@cache
def _of_machine() -> float:
    found = [float(os.sysconf("SC_PAGE_SIZE")) * os.sysconf("SC_PHYS_PAGES")]
    for group in GROUPS:
        try:
            found.append(float(Path(group).read_text(encoding="ascii")))
        except (OSError, ValueError):  # there is none, or it is "max"
            continue
    return min(found)


def refuse_beyond_memory(scene: AnyScene, parts: Mapping[str, float]) -> None:
    """Raise SceneError where a run's parts, bytes by the key that decides them, are too large."""
    if (asked := _asked.get()) is not None:
        asked.update(parts)
    total, limit = sum(parts.values()), memory()
    if total <= limit:
        return
    key = max(parts, key=lambda k: parts[k])
    raise SceneError(
        scene.where,
        key,
        value_of(scene, key),
        f"the run would need about {spoken(total)} of memory, {spoken(parts[key])} of it for this; "
        f"{spoken(limit)} available (set {LIMIT} to change it, in GB)",
    )


def require(size: float, what: str) -> None:
    """Raise MemoryError for more bytes than a run may take."""
    if size > memory():
        raise MemoryError(f"{what} would need about {spoken(size)}; {spoken(memory())} available")


@contextmanager
def within(room: float) -> Iterator[None]:
    """Make allocations beyond this many bytes raise MemoryError, if the system supports it."""
    try:
        pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0])
    except OSError:
        yield
        return
    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    asked = pages * resource.getpagesize() + int(room)
    resource.setrlimit(resource.RLIMIT_AS, (min(x for x in (asked, soft, hard) if x >= 0), hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, (soft, hard))


def value_of(scene: AnyScene, key: str) -> object:
    """Return the value of a dotted key of a scene."""
    found: object = scene
    for part in key.split("."):
        found = getattr(found, part)
    if isinstance(found, list):
        return f"{len(found):,} places"
    return found


def spoken(size: float) -> str:
    """Return bytes in words."""
    return f"{size / 1e9:.3g} GB" if size >= 1e9 else f"{size / 1e6:.3g} MB"


def samples_of(scene: AnyScene) -> float:
    """Return the number of samples of a scene."""
    return scene.time.duration / scene.interval + 1


def waveform_bytes(scene: AnyScene, spatial: bool = False) -> float:
    """Return the memory of waveforms and ledger (bytes), written copies included.

    Raises SceneError where one of them would not fit a file.
    """
    record, axes = scene.record, 3 if spatial else 1
    from jointwave.cases.schema.tables import Record

    if isinstance(record, Record):
        across, of_point = max(axes - 1, 1), axes * (3 if spatial else 2)
        rows = {
            "record.velocity": (len(record.velocity), axes, of_point),
            "record.stress": (len(record.stress), across, axes),
        }
    else:
        rows = {
            "record.points": (len(record.points), 3, 7),
            "record.joints": (len(record.joints), 2, 4),
        }
    samples = samples_of(scene)
    key, (places, most, _) = max(rows.items(), key=lambda row: row[1][0] * row[1][1])
    largest = 8 * samples * places * most
    if largest > LARGEST_VARIABLE:
        raise SceneError(
            scene.where,
            key,
            value_of(scene, key),
            f"with {samples:,.0f} samples gives waveforms of {spoken(largest)}; "
            f"at most {spoken(LARGEST_VARIABLE)} fit in a file",
        )
    count = sum(places * each for places, _, each in rows.values())
    return COPIES * 8 * samples * (count + (LEDGER if record.energy else 0))


def load_bytes(scene: AnyScene, steps: float) -> float:
    """Return the memory of the loads of this many steps (bytes)."""
    tables = [one.history is not None for one in scene.pulses]
    return steps * sum(TABLE_OF_STEP if table else LOAD_OF_STEP for table in tables)


def snapshot_bytes(scene: AnyScene, nodes: float) -> float:
    """Return the memory of snapshots of this many nodes (bytes)."""
    fields = scene.record.fields
    return 0.0 if fields is None else (scene.time.duration / fields + 1) * nodes * 7 * 8 * COPIES
