"""Memory of runs of rigid blocks, estimated before any of it is allocated."""

from jointwave.cases.run_memory import (
    load_bytes,
    refuse_beyond_memory,
    snapshot_bytes,
    waveform_bytes,
)
from jointwave.cases.sampling import Clock
from jointwave.cases.schema.scene import Scene

#: Bytes per block, while pillars are cut into them; with the model and its joint.
CUT = 400
AXIAL, SPATIAL = 500, 2000
#: Bytes per block for each contact point of joints that open or slide.
POINT = 60
CORNERS = 8  # of a block, in snapshots


def refuse_too_many(scene: Scene) -> None:
    """Raise SceneError for more blocks than can be cut in memory."""
    refuse_beyond_memory(scene, {"pillar.block": CUT * scene.block_count})


def refuse_large(scene: Scene, time: Clock, points: int | None = None) -> None:
    """Raise SceneError for a run that does not fit in memory.

    points : contact points with a history in each joint of blocks in space; None for axial motion.
    """
    spatial, blocks = points is not None, scene.block_count
    block = SPATIAL + POINT * points if points is not None else AXIAL
    parts = {
        "pillar.block": block * blocks,
        "record.interval": waveform_bytes(scene, spatial),
        "numerics.dem.step_fraction": load_bytes(scene, time.steps + time.stride),
        "record.fields": snapshot_bytes(scene, CORNERS * blocks),
    }
    refuse_beyond_memory(scene, parts)
