"""Sizes of elements, and the memory of a body, before any of it is made."""

from math import ceil, sqrt

import numpy as np

from jointwave.cases.geometry.blocks import Blocks
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.material.effective_medium import slowest
from jointwave.cases.run_memory import refuse_beyond_memory, snapshot_bytes
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.schema.pulse import shortest_period
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.cases.schema.scene import Scene

#: Elements in the way of the slowest wave in one period, by their order.
IN_PERIOD = {1: 40.0, 2: 12.0, 3: 6.0, 4: 4.0}
#: Times as many for pulses that start or end with a kink, and in simplices.
OF_KINKS, OF_SIMPLICES = 2.0, 1.5
#: Of the period: the longest travel time of a wave through one element of a pillar. A load that
#: starts like a sine has a kink, which only dashpots smooth as it propagates.
TRAVEL_OF_KINKS, TRAVEL_OF_DAMPED = 0.01, 0.04
#: Bytes a freedom, and for each entry of its row of the stiffness: the operators as they are made.
FREEDOM, ENTRY = 500, 40


def element_size(scene: RockMass, simplices: bool) -> float:
    """Return about how large elements are, m: `numerics.continuum.size`, or what resolves the
    slowest waves of the shortest pulse, in rock with its joints; those of a mesh as they are."""
    numerics = scene.numerics.continuum
    if numerics.size is not None or scene.domain.mesh is not None:
        return numerics.size or np.inf
    sharp = any(one.shape not in ("ricker", "gabor") for one in scene.pulses)
    many = IN_PERIOD[numerics.order] * (OF_KINKS if sharp else 1.0)
    return slowest(scene) * resolved_period(scene) / many / (OF_SIMPLICES if simplices else 1.0)


def elements_along(scene: Scene, model: str) -> np.ndarray:
    """Return how many elements resolve the waves in a block of each part of a pillar, int array."""
    given, counts = scene.numerics.continuum.elements_per_block, []
    for one in calibrate(scene).each:
        modulus = one.modulus if model == "equivalent" else one.intact_modulus
        assert modulus is not None
        travel = TRAVEL_OF_DAMPED if one.time_constant else TRAVEL_OF_KINKS
        element = sqrt(modulus / one.density) * travel * resolved_period(scene)
        counts.append(given or max(1, ceil(one.spacing / element * (1 - 1e-9))))
    return np.array(counts)


def resolved_period(scene: AnyScene) -> float:
    """Return the period (s) that elements resolve: the shortest of what acts, or a tenth of the
    scene."""
    return shortest_period(scene.pulses) or scene.time.duration / 10


def refuse_large_mesh(
    scene: AnyScene,
    blocks: Blocks,
    size: float,
    components: int,
    key: str = "numerics.continuum.size",
) -> None:
    """Raise SceneError where elements of this size (m), which a key decides, would not fit in
    memory."""
    order, dim = scene.numerics.continuum.order, blocks.body.dim
    surface = float(2 * blocks.contacts.area.sum() + blocks.boundary.area.sum()) / 2
    cells = float(blocks.volume.sum()) / size**dim + surface / size ** (dim - 1) + blocks.count
    nodes = cells * (order + 0.5) ** dim
    parts = {
        key: body_bytes(nodes, components, order, dim),
        "record.fields": snapshot_bytes(scene, nodes),
    }
    refuse_beyond_memory(scene, parts)


def body_bytes(nodes: float, components: int, order: int, dim: int) -> float:
    """Return the memory that a body takes, bytes."""
    return components * nodes * (FREEDOM + ENTRY * components * (order + 1) ** dim)
