"""Methods that a user would write instead, timed beside the engines."""

from types import ModuleType

from jointwave.compare.studies.methods import adaptive

#: Each module has NAME, ENGINE, whose model it solves, applies(scene) -> Answer and
#: solve(scene, **arguments) -> xarray.Dataset, with the names of the ARGUMENTS that a study varies.
METHODS: dict[str, ModuleType] = {module.NAME: module for module in (adaptive,)}
