"""A scene solved by all solutions that apply, with the misfits between them."""

from collections.abc import Mapping, Sequence

from jointwave.cases.errors import SceneError, require
from jointwave.cases.scene_type import AnyScene
from jointwave.compare.engines import Progress
from jointwave.compare.misfit.alignment import align_curve
from jointwave.compare.misfit.external import READ_CURVES, Curves
from jointwave.compare.misfit.pairs import Comparison, measure, measure_curves
from jointwave.compare.misfit.ranking import applicable
from jointwave.compare.runs.reuse import NOWHERE, ResultFolder
from jointwave.compare.scenes import AnySource, load
from jointwave.compare.solvers.record import Answer


def compare(
    scene: AnySource,
    curves: Sequence[Curves] = (),
    progress: Progress | None = None,
    align: bool = False,
    spectral: bool = False,
    stored: ResultFolder = NOWHERE,
) -> Comparison:
    """Return a scene solved by all solutions that apply, with the misfit of every pair.

    curves : external curves, from `read_curves`, to compare with every solution. progress : called
    with the finished fraction. align : whether to shift the curves in time onto the solution that
    fits best. spectral : whether to add envelope and phase misfits. stored : folder from which
    results are read and to which they are written; default: none.
    """
    scene = load(scene)
    for one in curves:
        require(one, Curves, "compare", "curves", READ_CURVES)
    comparison = solved(scene, applicable(scene), progress, stored)
    comparison.rows = measure(comparison.results, spectral, scene)
    for one in curves:
        beside = align_curve(one, scene, comparison.results, align)
        comparison.besides.append(beside)
        comparison.rows += measure_curves(beside, comparison.results, spectral)
    return comparison


def solved(
    scene: AnyScene,
    answers: Mapping[str, Answer],
    progress: Progress | None = None,
    stored: ResultFolder = NOWHERE,
) -> Comparison:
    """Solve a scene by the solutions that apply, without computing misfits.

    answers : whether each requested solution applies, by name. Failed solutions are logged and left
    out. Raises SceneError if none applies, and the first error if all fail.
    """
    if not any(answers.values()):
        why = "; ".join(f"{name}: {answer.reason}" for name, answer in answers.items())
        raise SceneError(scene.where, "", None, f"nothing solves it: {why}")
    able, failed = [name for name, answer in answers.items() if answer], dict[str, Exception]()
    results = dict(stored.solve(able, scene, progress, failed=failed))
    if not results:
        raise next(iter(failed.values()))
    reasons = {name: answer.reason for name, answer in answers.items() if not answer}
    reasons |= {name: str(error) for name, error in failed.items()}
    return Comparison(scene, results, reasons, failed=[*failed])
