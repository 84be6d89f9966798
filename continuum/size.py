"""Memory of runs of deformable rock, estimated before any of it is allocated."""

from jointwave.cases.run_memory import (
    load_bytes,
    refuse_beyond_memory,
    snapshot_bytes,
    waveform_bytes,
)
from jointwave.cases.sampling import Clock
from jointwave.cases.schema.pulse import shortest_period
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.cases.schema.scene import Scene
from jointwave.continuum.space.kinematics import Kinematics

#: Bytes a freedom, and for each entry of its row of the stiffness: the operators as they are made.
FREEDOM, ENTRY = 500, 40
#: Bytes of a mesh that is read for each byte of its file.
FILE = 10


def refuse_large_mesh(scene: Scene, motion: Kinematics, elements: int) -> None:
    """Raise SceneError where blocks of so many elements along the pillar would not fit."""
    numerics, count = scene.numerics.continuum, float(scene.block_count)
    order, across, components = numerics.order, motion.dim - 1, motion.section.components
    nodes = count * (elements * order + 1) * (numerics.elements_across * order + 1) ** across
    entries = components * (order + 1) ** motion.dim
    many = {"elements_per_block": elements, "elements_across": numerics.elements_across**across}
    most = max(many, key=lambda name: many[name])
    key = f"numerics.continuum.{most}" if many[most] > 1 else "pillar.block"
    size = nodes * components * (FREEDOM + ENTRY * entries)
    refuse_beyond_memory(scene, {key: size, "record.fields": snapshot_bytes(scene, nodes)})


def refuse_large_file(scene: Scene) -> None:
    """Raise SceneError where the mesh of a file would not fit."""
    path = scene.numerics.continuum.mesh_path
    assert path is not None
    size = float(path.stat().st_size) if path.is_file() else 0.0
    refuse_beyond_memory(scene, {"numerics.continuum.mesh": FILE * size})


def refuse_large_run(scene: Scene, motion: Kinematics, time: Clock) -> None:
    """Raise SceneError where the samples and the load of so many steps would not fit."""
    spatial = motion.section.components > 1
    parts = {
        "record.interval": waveform_bytes(scene, spatial),
        "time.duration": load_bytes(scene, time.steps),
    }
    refuse_beyond_memory(scene, parts)


def resolved_period(scene: Scene | RockMass) -> float:
    """Return the period (s) that elements resolve: the shortest of what acts, or a tenth of the
    scene."""
    return shortest_period(scene.pulses) or scene.time.duration / 10
