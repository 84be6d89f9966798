"""Size of the elements of a rock mass, and the memory of its mesh, before any of it is made."""

from __future__ import annotations

import numpy as np

from jointwave.cases.material.effective_medium import slowest
from jointwave.cases.partition.blocks import Partition
from jointwave.cases.run_memory import refuse_beyond_memory, snapshot_bytes
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.continuum.size import ENTRY, FREEDOM, resolved_period

#: Elements in the way of the slowest wave in one period, by their order.
IN_PERIOD = {1: 40.0, 2: 12.0, 3: 6.0, 4: 4.0}
#: Times as many for pulses that start or end with a kink, and in triangles: their diagonal mass
#: costs them an order.
OF_KINKS, OF_TRIANGLES = 2.0, 1.5


def element_sizes(scene: RockMass) -> dict[str, float]:
    """Return about how large quadrilaterals and triangles are, m: `numerics.continuum.size`, or
    what resolves the slowest waves of the shortest pulse, in rock with its joints; those of a mesh
    as they are."""
    numerics = scene.numerics.continuum
    if numerics.size is not None or scene.domain.mesh is not None:
        return dict.fromkeys(("quadrilateral", "triangle"), numerics.size or np.inf)
    sharp = any(one.shape not in ("ricker", "gabor") for one in scene.pulses)
    many = IN_PERIOD[numerics.order] * (OF_KINKS if sharp else 1.0)
    size = slowest(scene) * resolved_period(scene) / many
    return {"quadrilateral": size, "triangle": size / OF_TRIANGLES}


def refuse_large_mesh(scene: RockMass, partition: Partition, size: float) -> None:
    """Raise SceneError where elements of this size (m) would not fit in memory."""
    order = scene.numerics.continuum.order
    contacts = partition.contacts
    along = float(contacts.area.sum() + partition.boundary.area.sum())
    cells = float(partition.area.sum()) / size**2 + along / size + partition.count
    nodes, entries = cells * (order + 0.5) ** 2, 2 * (order + 1) ** 2
    parts = {
        "numerics.continuum.size": 2 * nodes * (FREEDOM + ENTRY * entries),
        "record.fields": snapshot_bytes(scene, nodes),
    }
    refuse_beyond_memory(scene, parts)
