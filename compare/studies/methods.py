"""What a user would write instead, timed beside the engines."""

from collections.abc import Callable

import xarray as xr

from compare.studies.adaptive import solve_chain

#: Functions of a scene and the study's arguments that return a result.
METHODS: dict[str, Callable[..., xr.Dataset]] = {"solve-ivp": solve_chain}
