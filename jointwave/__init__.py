"""Stress waves in jointed rock by two engines, held against exact solutions: the Python interface.

    import jointwave as jw

    scene = jw.load("guo-li-2002/fig-03")
    blocks, rock = jw.simulate(scene, "dem"), jw.simulate(scene, "continuum-jointed")
    print(jw.misfit(blocks, rock))

Results are xarray Datasets in SI units, compression positive. What a function needs is imported
when it is first called.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

# Loaded first: later imports of the package leave its name to the function below.
import jointwave.compare  # noqa: F401

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from xarray import DataArray, Dataset

    from jointwave.cases.material.calibrate import Properties
    from jointwave.cases.material.closure import Closure
    from jointwave.cases.scene_type import AnyScene
    from jointwave.compare.misfit.external import Curves
    from jointwave.compare.misfit.pairs import Comparison
    from jointwave.compare.readings import (
        arias_intensity,
        dispersion,
        dispersion_theory,
        peak_velocity,
        peak_velocity_map,
        quality_factor,
        recording,
        response_spectrum,
        transfer_function,
        wave_speed,
    )
    from jointwave.compare.report.verdict import VariantScore
    from jointwave.compare.studies.fit import Fit
    from jointwave.compare.studies.plan import Plan

__all__ = [
    "arias_intensity",
    "bandis_closure",
    "compare",
    "deconvolve",
    "dispersion",
    "dispersion_theory",
    "figure",
    "fit",
    "load",
    "load_variants",
    "misfit",
    "peak_velocity",
    "peak_velocity_map",
    "plan",
    "properties",
    "quality_factor",
    "read_curves",
    "recording",
    "response_spectrum",
    "shipped",
    "simulate",
    "solvers",
    "transfer_function",
    "verdicts",
    "wave_speed",
]

Progress = Callable[[float], None]


def load(
    scene: str | Path | dict[str, Any], variant: str = "", changes: dict[str, Any] | None = None
) -> AnyScene:
    """Return a scene, immutable and validated.

    scene : a file, a shipped scene ("guo-li-2002/fig-03"), or its tables as a dictionary.
    variant : its name; empty: the scene as it stands. changes : of keys by their dotted path,
    {"joints.damping_ratio": 0.02}.

    Raises jointwave.SceneError, a line a mistake with file, key, value and what is allowed.
    """
    from jointwave.cases.read import load_tables
    from jointwave.compare.scenes import known, load_variant

    if isinstance(scene, dict):
        return known(load_tables(scene, variant, changes))
    return load_variant(_file(scene), variant, changes)


def load_variants(scene: str | Path, changes: dict[str, Any] | None = None) -> list[AnyScene]:
    """Return a scene and all its variants, each as `load` does."""
    from jointwave.compare import scenes

    return scenes.load(_file(scene), changes)


def shipped() -> list[str]:
    """Return the names of the scenes that come along."""
    from jointwave.compare.scenes import names

    return names()


def properties(scene: AnyScene) -> Properties:
    """Return what follows from a scene: stiffnesses, speeds, impedance, damping, of every joint."""
    from jointwave.cases.material.calibrate import calibrate
    from jointwave.cases.scene_type import pillar_of

    return calibrate(pillar_of(scene, "jointwave.properties"))


def bandis_closure(roughness: float, wall_strength: float, rock_strength: float) -> Closure:
    """Return initial aperture (m), normal stiffness (Pa/m) and maximum closure (m) of a joint from
    its JRC, its JCS (Pa) and the uniaxial compressive strength of the rock (Pa).

    Raises ValueError beyond what Bandis et al. (1983) measured.
    """
    from jointwave.cases.material import closure

    return closure.bandis_closure(roughness, wall_strength, rock_strength)


def solvers(scene: AnyScene) -> dict[str, str]:
    """Return all engines and exact solutions of a scene's kind by name, with the reason why one
    does not hold for it; an empty one where it does."""
    from jointwave.compare.misfit.ranking import applicable

    return {name: answer.reason for name, answer in applicable(scene).items()}


def simulate(
    scene: AnyScene, solver: str = "dem", progress: Progress | None = None, **options: Any
) -> Dataset:
    """Return waveforms, energies and cost of a scene by an engine or an exact solution.

    solver : "dem" (rigid blocks), "continuum-jointed", "continuum-equivalent", or an exact solution
    ("lattice"; see `solvers`). progress : called with the finished fraction. options : `comm`, of
    mpi4py, for a continuum that several processes share; `keeper`, for checkpoints.

    Raises SceneError where the solver does not hold, UnstableError where a run loses its bound.
    """
    from jointwave.compare.engines import solve

    return solve(solver, scene, progress, **options)


def compare(
    scene: AnyScene,
    curves: Sequence[Curves] = (),
    progress: Progress | None = None,
    align: bool = False,
) -> Comparison:
    """Return a scene by everything that holds for it, with the distances of all pairs.

    curves : of others, as `read_curves` returns them; align : whether their clocks are moved.
    """
    from jointwave.compare.runs import comparison

    return comparison.compare(scene, progress, curves=curves, align=align)


def deconvolve(scene: AnyScene, surface: DataArray, water_level: float = 1e-3) -> DataArray:
    """Return what comes up to a column's quiet start, from the motion of its free end: a table for
    a compliant base.

    scene : a pillar with linear joints, ends "quiet" and "free"; of its load the direction counts.
    surface : velocity or acceleration over `time` alone. water_level : of the largest transfer;
    frequencies that the joints pass less of are held back. The result begins earlier than the
    record, by the time that intact rock takes. Raises SceneError where the column is not linear.
    """
    from jointwave.cases.scene_type import pillar_of
    from jointwave.compare.exact.bar import deconvolution

    return deconvolution.deconvolve(pillar_of(scene, "deconvolve"), surface, water_level)


def misfit(one: Dataset, other: Dataset) -> float:
    """Return the relative L2 misfit of two results of a scene: that of the waveform, one component
    of one quantity at one receiver less its static state, which is furthest off, of those that
    carry at least 5 % of their quantity's motion at the receiver."""
    from jointwave.compare.misfit import metrics

    return metrics.misfit(one, other)


def verdicts(comparison: Comparison) -> dict[str, VariantScore]:
    """Return the verdict on each engine of a comparison by name: `total`, its worst misfit from the
    reference `against`, `peaks`, the differences in PPV and peak stress, mean and worst over the
    receivers, and `own`, its numerical error; `facts` has all as plain numbers and words."""
    from jointwave.compare.report.verdict import ENGINES, score

    return {name: score(name, comparison) for name in ENGINES if name in comparison.results}


def read_curves(files: Sequence[str], scenes: Sequence[AnyScene]) -> list[Curves]:
    """Return waveforms of another code, a figure or an experiment: FILE, FILE:stress@20 or
    FILE:COLUMN=stress@20 each, a table, a seismogram or NetCDF."""
    from jointwave.compare.misfit import external as curves

    return curves.read_curves(list(files), list(scenes))


def fit(
    scene: AnyScene,
    curves: Sequence[Curves],
    free: Sequence[str],
    solver: str | None = None,
    progress: Progress | None = None,
) -> Fit:
    """Return keys of a scene fitted to measured waveforms by least squares, with 95 % intervals.

    free : dotted keys, KEY, KEY=START or KEY=LOW:START:HIGH, and `clock`. solver : as
    of `simulate`; None: the exact chain of rigid blocks where it holds and is short, else "dem".

    Raises SceneError for what cannot be fitted, StoppedError where the search does not converge.
    """
    from jointwave.compare.studies import fit as fitting

    return fitting.fit(scene, curves, free, solver, progress)


def plan(
    scene: AnyScene, misfit: float, seconds: float | None = None, progress: Progress | None = None
) -> Plan:
    """Return the cheapest engine, elements and step within a misfit, numerical and modelling error
    together, run; seconds : instead the best within so many of stepping.

    Raises SceneError where nothing exact is known of the scene, and no run converges in reach.
    """
    from jointwave.compare.studies import plan as plans

    return plans.plan(scene, misfit, seconds, progress)


def figure(
    comparisons: Sequence[Comparison], width: float = 190.0, font_size: float = 8.0
) -> Figure:
    """Return a figure for a paper of a scene's comparisons, a variant each.

    width : mm. font_size : points.
    """
    from jointwave.compare.figures.charts.waveforms import draw_solutions
    from jointwave.compare.figures.style import printed

    return draw_solutions(list(comparisons), False, printed(width, font_size))


def _file(scene: str | Path) -> Path:
    from jointwave.compare.scenes import find

    return find(str(scene))


def __getattr__(name: str) -> Any:
    """Return the exceptions, the class of scenes and what is read off results, imported when they
    are asked for."""
    if name in ("SceneError", "StoppedError", "UnstableError"):
        from jointwave.cases import errors

        return getattr(errors, name)
    if name == "Scene":
        from jointwave.cases.schema.scene import Scene

        return Scene
    if name in __all__:
        from jointwave.compare import readings

        return getattr(readings, name)
    raise AttributeError(f"module 'jointwave' has no attribute {name!r}")
