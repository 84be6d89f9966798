"""Sizes of elements that waves need, and the memory of a body."""

from collections.abc import Iterator
from math import ceil, sqrt

import numpy as np

from jointwave.cases.errors import SceneError, placed
from jointwave.cases.geometry.blocks import Blocks
from jointwave.cases.loads import LEAST_BLOCKS, highest_frequency
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.material.effective_medium import slowest
from jointwave.cases.run_memory import refuse_beyond_memory, snapshot_bytes
from jointwave.cases.sampling import resolved_period
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.cases.schema.scene import Scene
from jointwave.cases.size import excess
from jointwave.cases.warnings.sources import of_resolution

#: Elements per wavelength of the slowest wave at the shortest period, by order.
IN_PERIOD = {1: 40.0, 2: 12.0, 3: 6.0, 4: 4.0}
#: Factors on it for pulses that start or end with a kink, and for simplices.
OF_KINKS, OF_SIMPLICES = 2.0, 1.5
#: Longest travel time of a wave through an element of a pillar, over the period. A load that starts
#: like a sine has a kink, which only dashpots smooth as it propagates.
TRAVEL_OF_KINKS, TRAVEL_OF_DAMPED = 0.01, 0.04
#: Bytes a freedom, and bytes an entry of the stiffness, during assembly.
FREEDOM, ENTRY = 500, 40
FLUID = 1e-9  # modulus, over the largest one, below which rock has no shear waves


def element_size(scene: RockMass, simplices: bool, least: float) -> float:
    """Return the approximate size of elements, m: `numerics.continuum.size`, or one that resolves
    the slowest waves of the shortest pulse in jointed rock; infinite for the blocks of a mesh.

    least : extent of the rock along its shortest axis, m. No shorter wave matters without pulses.
    """
    numerics = scene.numerics.continuum
    if numerics.size is not None or scene.domain.mesh is not None:
        return numerics.size or np.inf
    sharp = any(one.shape not in ("ricker", "gabor") for one in scene.pulses)
    many = IN_PERIOD[numerics.order] * (OF_KINKS if sharp else 1.0)
    wave = slowest(scene) * resolved_period(scene)
    wave = wave if scene.pulses else max(wave, least)
    return wave / many / (OF_SIMPLICES if simplices else 1.0)


def elements_along(scene: Scene, model: str) -> np.ndarray:
    """Return the number of elements that resolve the waves in a block of each part of a pillar."""
    given, counts = scene.numerics.continuum.elements_per_block, []
    for one in calibrate(scene).each:
        modulus = one.modulus if model == "equivalent" else one.intact_modulus
        assert modulus is not None
        travel = TRAVEL_OF_DAMPED if one.time_constant else TRAVEL_OF_KINKS
        element = sqrt(modulus / one.density) * travel * resolved_period(scene)
        counts.append(given or max(1, ceil(one.spacing / element * (1 - 1e-9))))
    return np.array(counts)


def refuse_large_mesh(
    scene: AnyScene,
    blocks: Blocks,
    size: float,
    components: int,
    key: str = "numerics.continuum.size",
) -> None:
    """Raise SceneError if elements of this size (m) do not fit in memory; key : sets the size."""
    order, dim = scene.numerics.continuum.order, blocks.body.dim
    surface = float(2 * blocks.contacts.area.sum() + blocks.boundary.area.sum()) / 2

    def parts(size: float) -> dict[str, float]:
        cells = float(blocks.volume.sum()) / size**dim + surface / size ** (dim - 1) + blocks.count
        nodes = cells * (order + 0.5) ** dim
        body = body_bytes(nodes, components, order, dim)
        return {key: body, "record.fields": snapshot_bytes(scene, nodes)}

    try:
        refuse_beyond_memory(scene, parts(size))
    except SceneError as error:
        larger = (1.1**k * size for k in range(100))
        fits = next((one for one in larger if not excess(sum(parts(one).values()))), None)
        if fits is None or not key.endswith("size"):
            raise
        allowed = f"{error.allowed}; elements of {1.05 * fits:.2g} m fit"  # rounded upwards
        raise SceneError(error.where, error.key, error.value, allowed) from None


def body_bytes(nodes: float, components: int, order: int, dim: int) -> float:
    """Return the memory of a body, bytes."""
    return components * nodes * (FREEDOM + ENTRY * components * (order + 1) ** dim)


def of_coarse_cells(
    scene: AnyScene, what: str, corners: np.ndarray, moduli: np.ndarray, density: np.ndarray
) -> Iterator[str]:
    """Warn of cells, of a file or with a script's rock, too large for the shortest wave: S waves at
    the highest frequency, or axial waves in an axial pillar, along the axes of its receivers.

    what : the mesh or the rock, in words. corners : of cells [cells, n, d], m. moduli : stiffness
    of their rock in Voigt's form [cells, n, n], Pa. density : [cells], kg/m3.
    """
    frequency = highest_frequency(scene)
    if frequency is None:
        return
    axis, travels = corners.shape[2] // 2, ["xyz".index(one) for one in scene.axes]
    size = np.ptp(corners, axis=1)[:, np.minimum(travels, corners.shape[2] - 1)]
    if not scene.is_spatial:
        least = moduli[:, axis, axis]
    else:  # the shear modulus of isotropic rock, the modulus under pressure of a fluid
        values = np.linalg.eigvalsh(moduli)
        least = np.where(values > FLUID * values.max(), values, np.inf).min(axis=1)
    wave = np.sqrt(least / density) / frequency
    nodes = scene.numerics.continuum.order * wave / size.max(axis=1)
    worst = int(nodes.argmin())
    place = placed(corners[worst].mean(axis=0), 4)
    gives = f"{what}: elements at {place} have"
    where = f"nodes per wavelength at {frequency:.4g} Hz, below which 95 % of the energy lies"
    remedy = ""
    if not scene.is_column:
        given = min(float(size.max(axis=1)[worst]), scene.numerics.continuum.size or np.inf)
        remedy = f": numerics.continuum.size = {given * nodes[worst] / LEAST_BLOCKS:.2g} m"
    yield from of_resolution(gives, float(nodes[worst]), where, remedy)
