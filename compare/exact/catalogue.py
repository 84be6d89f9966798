"""All exact solutions by name, from the one that a model discretises to the coarser ones."""

from types import ModuleType

from compare.exact.bar import equivalent_bar, images, jointed_bar, kelvin_voigt, series
from compare.exact.blocks import lattice, no_tension, sliding_block, spatial_lattice
from compare.exact.joint import one_joint, sliding_joint

#: Each module has NAME, RESOLVES, applies(scene) -> Answer and solve(scene) -> xarray.Dataset; what
#: they need of scipy is imported only when they solve.
CATALOGUE: dict[str, ModuleType] = {
    module.NAME: module
    for module in (
        lattice,
        no_tension,
        jointed_bar,
        equivalent_bar,
        images,
        series,
        kelvin_voigt,
        one_joint,
        spatial_lattice,
        sliding_joint,
        sliding_block,
    )
}
