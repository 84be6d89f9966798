"""Input of the commands: scenes with changed keys, external curves, warnings, stored results."""

from collections.abc import Callable, Iterable, Sequence
from itertools import product
from pathlib import Path

from jointwave.cases.errors import SceneError, all_of
from jointwave.cases.read import parse_override
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.warnings import warnings
from jointwave.compare import scenes
from jointwave.compare.cli.options import SceneOptions, StoredOptions
from jointwave.compare.cli.terminal import say_warnings
from jointwave.compare.misfit.alignment import common_times
from jointwave.compare.misfit.external import Curves, doubts, read_curves
from jointwave.compare.runs.reuse import ResultFolder
from jointwave.compare.solvers.incident import side_warnings

RESULTS = Path("out")  # default folder of results, with a subfolder for each scene


def load(asked: SceneOptions, every: bool = True) -> list[AnyScene]:
    """Return the scenes of a command, with `--set` applied and warnings printed: the named variant;
    if none is named all variants or, if not `every`, the base scene."""
    changes = dict(map(parse_override, asked.changes))
    if asked.variant is None and every:
        found = scenes.load_variants(asked.scene, changes)
    else:
        found = [scenes.load(asked.scene, asked.variant or "", changes)]
    warn(found, asked.strict)
    return found


def curves_of(
    given: list[str], scenes: list[AnyScene], strict: bool, align: bool = False
) -> list[Curves]:
    """Read the curves of `--with`, and report mistakes and doubts before anything is solved."""
    if not given:
        if align:
            raise SceneError("--align", "", None, "needs --with: there is no curve to align")
        return []
    curves = read_curves(given, scenes)
    for scene, one in product(scenes if not align else (), curves):
        common_times(one, scene)
    warn(scenes, strict, lambda scene: doubts(curves, scene))
    return curves


def stored_in(asked: StoredOptions, out: Path | None = None) -> ResultFolder:
    """Return the folder of stored results of a scene; out : used if --results is not given."""
    return ResultFolder(results_of(asked.scene, asked.results or out), asked.fresh)


def results_of(scene: str = "", given: Path | None = None) -> Path:
    """Return the folder of a scene's results, given or default, or of all scenes' results."""
    return given or RESULTS / Path(scene).stem


def scene_warnings(scene: AnyScene) -> list[str]:
    """Return warnings about probable mistakes in a scene."""
    return [*warnings(scene), *side_warnings(scene)]


def warn(
    scenes: Sequence[AnyScene],
    strict: bool = False,
    of: Callable[[AnyScene], Iterable[str]] = scene_warnings,
) -> None:
    """Print the warnings of scenes, each line once, after the first of several variants it is of.

    strict : raise them as one SceneError instead. of : returns the lines of a scene.
    """
    said: dict[str, str] = {}
    for scene in scenes:
        for line in of(scene):
            said.setdefault(line, scene.name if len(scenes) > 1 else "")
    lines = [f"{name}: {line}" if name else line for line, name in said.items()]
    if strict and lines:
        where, why = scenes[0].where, "(an error by --strict)"
        raise all_of(SceneError(where, "", None, f"{line} {why}") for line in lines)
    say_warnings(lines)
