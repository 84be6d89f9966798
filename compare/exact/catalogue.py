"""All exact solutions by name, from the one that a model discretises to the coarser ones."""

from types import ModuleType

from compare.exact import (
    equivalent_bar,
    images,
    jointed_bar,
    kelvin_voigt,
    lattice,
    no_tension,
    one_joint,
    series,
    sliding_block,
    sliding_joint,
    spatial_lattice,
)

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
