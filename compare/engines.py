"""Everything that can solve a scene, by name: the two engines and the exact solutions."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from cases.errors import SceneError
from cases.schema.scene import Scene
from cases.size import refuse_beyond_memory, waveform_bytes
from compare.exact.answer import YES, Answer, Form, Resolves, Rock, no
from numerics.checkpoint import Keeper

if TYPE_CHECKING:
    import xarray as xr

#: What each engine resolves.
ENGINES = {
    "dem": Resolves(Rock.RIGID_BLOCKS, Form.RUN, dimension=3),
    "continuum-jointed": Resolves(Rock.JOINTED, Form.RUN, dimension=3),
    "continuum-equivalent": Resolves(Rock.HOMOGENISED, Form.RUN, dimension=3),
}

Progress = Callable[[float], None]


def exact_names() -> tuple[str, ...]:
    """Return the names of all exact solutions."""
    from compare.exact.catalogue import CATALOGUE

    return tuple(CATALOGUE)


def names() -> tuple[str, ...]:
    """Return the names of everything that can solve a scene."""
    return (*ENGINES, *exact_names())


def applies(name: str, scene: Scene) -> Answer:
    """Return whether this engine or solution holds for the scene, or the reason why not."""
    if name == "dem":
        return YES
    if name.startswith("continuum-"):
        try:
            from continuum import applies as continuum_applies
        except ImportError as error:
            return no(f"dolfinx cannot be imported ({error})")
        reason = continuum_applies(scene, name.removeprefix("continuum-"))
        return no(reason) if reason else YES
    return _exact(name).applies(scene)


def solve(
    name: str,
    scene: Scene,
    progress: Progress | None = None,
    comm=None,
    keeper: Keeper | None = None,
) -> xr.Dataset:
    """Return the result of one engine or exact solution.

    comm : mpi4py's communicator of processes that share a run of the continuum, None without.
    keeper : watches over a run of an engine; None: nobody.
    Raises SceneError where it does not apply or the name is unknown, UnstableError where a run
    goes unstable.
    """
    answer = applies(name, scene)
    if not answer:
        raise SceneError(scene.title, "", None, f"{name} does not apply: {answer.reason}")
    if name == "dem":
        from dem import simulate

        return simulate(scene, progress, keeper=keeper)
    if name.startswith("continuum-"):
        from continuum import simulate as simulate_continuum

        model = name.removeprefix("continuum-")
        return simulate_continuum(scene, model=model, progress=progress, comm=comm, keeper=keeper)
    try:
        refuse_beyond_memory(scene, {"record.interval": waveform_bytes(scene)})
        return _exact(name).solve(scene)
    except MemoryError as error:
        raise SceneError(scene.where, "", None, f"not enough memory: {name}: {error}") from None


def _exact(name: str):
    from compare.exact.catalogue import CATALOGUE

    if name not in CATALOGUE:
        raise SceneError("engine", "", None, f"{name!r} is unknown; allowed: {', '.join(names())}")
    return CATALOGUE[name]
