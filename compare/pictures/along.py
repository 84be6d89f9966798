"""A scene solved at sections all along the pillar, for space-time diagrams."""

import xarray as xr

from cases.scene import Scene
from compare.engines import ENGINES, applies, solve
from compare.pairs import BETWEEN, PAIRS, Pair

SECTIONS, TIMES = 60, 240  # at most so many intervals between the sections and samples kept
FEWEST = 8  # blocks; in fewer there is no wave to be seen


def along_pillar(scene: Scene) -> dict[str, xr.Dataset]:
    """Return results by name at joints all along the pillar, at some 240 times.

    Those of the engines, each run as in the comparison, and of the exact solution that referees
    each. Empty where the pillar has too few blocks for a wave to be seen.
    Raises what `compare.engines.solve` does.
    """
    if scene.pillar.block_count < FEWEST:
        return {}
    wide = recorded_along(scene)
    names = [name for name in ENGINES if applies(name, wide)]
    exact = [[p.other for p in referees(name) if applies(p.other, wide)][:1] for name in names]
    every = dict.fromkeys([*names, *(name for found in exact for name in found)])
    return {name: _thinned(solve(name, wide)) for name in every}


def referees(engine: str) -> list[Pair]:
    """Return what an engine can be held against but other engines, its own model's first."""
    return [pair for pair in PAIRS if pair.one == engine and pair.kind != BETWEEN]


def sections(scene: Scene) -> list[float]:
    """Return y of the start, every k-th joint and the end, m."""
    count = scene.pillar.block_count
    places = [*range(0, count, -(-count // SECTIONS)), count]
    return [scene.pillar.block * i for i in places]


def recorded_along(scene: Scene) -> Scene:
    """Return the scene with receivers along the pillar; samples and steps stay as they are."""
    places = sections(scene)
    # A couple about the axis strains no section; what it turns is recorded with the velocity.
    points = places if scene.load.arm is not None else []
    record = scene.record.model_copy(update={"stress": places, "velocity": points, "fields": None})
    return scene.model_copy(update={"record": record})


def _thinned(result: xr.Dataset) -> xr.Dataset:
    """Return a result at every k-th sample, in memory of its own."""
    step = max(1, -(-(result.sizes["time"] - 1) // TIMES))
    return result.isel(time=slice(None, None, step)).copy(deep=True)
