"""Scenes by path or by shipped name, with the solver names in [expect] checked."""

from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

from jointwave import cases
from jointwave.cases.errors import SceneError, nearest, require
from jointwave.cases.scene_type import AnyScene, pillar_of
from jointwave.compare import engines as registry
from jointwave.results.labels import PEAKS, QUANTITIES

if TYPE_CHECKING:
    import xarray as xr

    from jointwave.cases.material.calibrate import Properties

#: A scene, its file, the name of a shipped scene, or its tables.
AnySource: TypeAlias = "AnyScene | str | PathLike[str] | dict[str, Any]"
SHIPPED = Path(cases.__file__).parent
MOST = 1000  # files of a folder searched for a similar name


class Bound(NamedTuple):
    """The subject of a key of [expect]: the misfit of a solution from another, the reference, for
    the worst waveform or for one quantity or peak, `of`."""

    one: str
    other: str
    of: str = ""


def bound_of(key: str) -> Bound:
    """Return the subject of a key such as "dem ~ lattice" or "dem ~ lattice: velocity"."""
    pair, _, of = key.partition(": ")
    one, _, other = pair.partition(" ~ ")
    return Bound(one, other, of)


def shipped_files() -> list[Path]:
    """Return the shipped scene files, in order."""
    return sorted(SHIPPED.glob("*/*.toml"))


def find(scene: str | Path) -> Path:
    """Return the file of a scene given by path or by shipped name, `guo-li-2002/fig-03`.

    Raises SceneError for an unknown name, with a similar name if there is one.
    """
    path = Path(scene)
    if path.exists() or path.is_symlink():
        return path
    known = (SHIPPED / scene).with_suffix(".toml")
    if known.is_file():
        return known
    if meant := nearest(str(scene), [*_beside(path), *shipped()]):
        raise SceneError(str(scene), "", None, f"cannot be read: no such scene{meant}")
    if not path.suffix:
        allowed = "is neither a file nor a shipped scene; `jointwave list` names the shipped ones"
        raise SceneError(str(scene), "", None, allowed)
    return path


def load(scene: AnySource, variant: str = "", changes: dict[str, Any] | None = None) -> AnyScene:
    """Return a scene, immutable and validated. Other functions accept the same kinds of `scene`.

    scene : a file, a shipped scene ("guo-li-2002/fig-03"), its tables as a dictionary, or a scene,
    which is checked and returned. variant : its name; empty: the base scene. changes : of keys by
    dotted path, {"joints.damping_ratio": 0.02}.

    Raises jointwave.SceneError, one line per mistake with file, key, value and what is allowed.
    """
    require(variant, str, "load", "variant", "the name of one; keys are set by changes={...}")
    require(changes, dict | None, "load", "changes", 'a dictionary, {"time.duration": 0.1}')
    if isinstance(scene, dict):
        return _checked(cases.load_tables(scene, variant, changes))
    if isinstance(scene, str | PathLike):
        return _checked(cases.load_variant(find(Path(scene)), variant, changes))
    if getattr(scene, "kind", "") not in ("pillar", "rock mass"):
        allowed = "must be a file, the name of a shipped scene, tables, or a loaded scene"
        raise SceneError("scene", "type", type(scene).__name__, allowed)
    if variant or changes:
        allowed = "are of a file, a shipped scene or tables, not of a loaded scene"
        raise SceneError(scene.where, "variant and changes", None, allowed)
    from jointwave.cases.validate import checked  # imports numpy, which completion does not need

    return checked(scene)


def properties(scene: AnySource) -> "Properties":
    """Return the calibrated stiffnesses, wave speeds, impedance and joint damping of a pillar.

    Joints that stiffen have their initial stiffness; `at_start.at_rest` and `at_end.at_rest` are
    the rock whose joints the prestress has closed. Raises SceneError for a rock mass.
    """
    from jointwave.cases.material.calibrate import calibrate

    return calibrate(pillar_of(load(scene), "jointwave.properties"))


def simulate(
    scene: AnySource, solver: str = "dem", progress: registry.Progress | None = None, **options: Any
) -> "xr.Dataset":
    """Return waveforms, energies and cost of a scene, from an engine or an exact solution.

    scene : see `load`. solver : "dem" (rigid blocks), "continuum-jointed", "continuum-equivalent",
    or an exact solution ("lattice"; see `solvers`). progress : called with the finished fraction.
    options : `comm`, of mpi4py, for a continuum shared by several processes; `keeper`, for
    checkpoints.

    Raises SceneError if the solver does not apply, UnstableError if a run becomes unstable.
    """
    return registry.solve(solver, load(scene), progress, **options)


def load_variants(
    scene: str | PathLike[str], changes: dict[str, Any] | None = None
) -> list[AnyScene]:
    """Return the scene of a file, or a shipped scene, and all its variants, see `load`."""
    if not isinstance(scene, str | PathLike):
        allowed = "must be a file or the name of a shipped scene"
        raise SceneError("scene", "type", type(scene).__name__, allowed)
    return [_checked(one) for one in cases.load(find(Path(scene)), changes)]


def _checked(scene: Any) -> Any:
    """Return a scene; raises SceneError if its [expect] names an unknown solver or quantity."""
    pair = registry.names(), "be 'a ~ b', two of"
    quantity = ("", *QUANTITIES, *PEAKS), "end in ': ' and one of"
    for key in scene.expect:
        one, other, of = bound_of(key)
        for name, (known, must) in ((one, pair), (other, pair), (of, quantity)):
            if name not in known:
                allowed = f"must {must} {', '.join(filter(None, known))}{nearest(name, known)}"
                raise SceneError(scene.where, f"expect.{key}", None, allowed)
    return scene


def shipped() -> list[str]:
    """Return the names of the shipped scenes, `guo-li-2002/fig-03`, in order."""
    return [path.relative_to(SHIPPED).with_suffix("").as_posix() for path in shipped_files()]


def _beside(path: Path) -> list[str]:
    try:
        return [str(file) for file in sorted(path.parent.glob("*.toml"))][:MOST]
    except (OSError, ValueError):  # no folder, a NUL
        return []
