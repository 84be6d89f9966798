"""The memory of a run, estimated before any of it is allocated.

Each engine estimates its arrays from the numbers of blocks, samples and steps, by the scene key
that sets each part. A run is refused if the sum exceeds `memory()`.
"""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from functools import reduce
from typing import Any

from jointwave.cases.errors import SceneError
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.size import LARGEST_VARIABLE, excess, spoken

#: Bytes per step for the load's mean and its intermediate arrays, by formula and by table.
LOAD_OF_STEP, TABLE_OF_STEP = 24, 64
LEDGER = 5  # least number of terms of an energy ledger
#: Components of the largest waveform of a receiver, and of all of them, by key of [record]: along
#: one axis of axial motion, and of any motion.
AXIAL = {"velocity": (1, 2), "stress": (1, 1)}
COMPONENTS = {
    "y": {"velocity": (3, 9), "stress": (2, 3)},
    "xy": {"points": (3, 7), "joints": (2, 4)},
    "xyz": {"points": (6, 12), "joints": (3, 6)},
}
#: Copies of a waveform in memory: sampled, and written.
COPIES = 2


#: Collects the estimates inside `estimates`.
_collected: ContextVar[dict[str, float] | None] = ContextVar("_collected", default=None)


@contextmanager
def estimates() -> Iterator[dict[str, float]]:
    """Collect the memory of the parts of a run (bytes, by the key that sets them) from the checks
    made in this context; of several checks of one key the largest."""
    parts: dict[str, float] = {}
    token = _collected.set(parts)
    try:
        yield parts
    finally:
        _collected.reset(token)


def refuse_beyond_memory(scene: AnyScene, parts: Mapping[str, float]) -> None:
    """Raise SceneError if the parts of a run (bytes by the key that sets them) are too large."""
    if (asked := _collected.get()) is not None:
        asked.update({key: max(size, asked.get(key, 0.0)) for key, size in parts.items()})
    key = max(parts, key=lambda k: parts[k])
    if why := excess(sum(parts.values()), f", {spoken(parts[key])} of it for this"):
        raise SceneError(scene.where, key, value_of(scene, key), f"the run {why}")


def value_of(scene: Any, key: str) -> object:
    """Return the value of a scene's dotted key, for messages."""
    found = reduce(getattr, key.split("."), scene)
    return f"{len(found):,} places" if isinstance(found, list) else found


def waveform_bytes(scene: AnyScene, spatial: bool = False) -> float:
    """Return the memory of waveforms and energy ledger, written copies included, bytes; spatial :
    whether a pillar moves across its axis. Raises SceneError if one does not fit into a file."""
    of_place = COMPONENTS[scene.axes] if spatial or scene.is_spatial else AXIAL
    rows = {f"record.{k}": (len(getattr(scene.record, k)), *each) for k, each in of_place.items()}
    samples = scene.time.duration / scene.interval + 1
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
    return COPIES * 8 * samples * (count + (LEDGER if scene.record.energy else 0))


def load_bytes(scene: AnyScene, steps: float) -> float:
    """Return the memory of the loads over this many steps, bytes."""
    tables = [one.history is not None for one in scene.pulses]
    return steps * sum(TABLE_OF_STEP if table else LOAD_OF_STEP for table in tables)


def snapshot_bytes(scene: AnyScene, nodes: float, values: float = 7) -> float:
    """Return the memory of snapshots of this many nodes with this many values each, bytes."""
    if (fields := scene.record.fields) is None:
        return 0.0
    return (scene.time.duration / fields + 1) * nodes * values * 8 * COPIES
