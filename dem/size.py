"""Memory of runs of rigid blocks, estimated before any of it is allocated."""

from cases.sampling import Clock
from cases.schema.scene import Scene
from cases.size import load_bytes, refuse_beyond_memory, snapshot_bytes, waveform_bytes

#: Bytes a block, with all that makes the model and all that can be remembered of its joint.
AXIAL, SPATIAL = 80, 200
#: Bytes a block for each contact point of joints that open or slide.
POINT = 60
CORNERS = 8  # of a block, in snapshots


def refuse_large(scene: Scene, time: Clock, points: int | None = None, stages: int = 1) -> None:
    """Raise SceneError where a run would not fit the memory.

    points : contact points that each joint of blocks in space looks after; None for axial motion.
    stages : of a step, at each of which the load acts.
    """
    spatial, blocks = points is not None, scene.block_count
    block = SPATIAL + POINT * points if points is not None else AXIAL
    parts = {
        "pillar.block": block * blocks,
        "record.interval": waveform_bytes(scene, spatial),
        "numerics.dem.step_fraction": load_bytes(scene, stages * (time.steps + time.stride)),
        "record.fields": snapshot_bytes(scene, CORNERS * blocks),
    }
    refuse_beyond_memory(scene, parts)
