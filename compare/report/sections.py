"""The sections of the page that are not scenes: studies, effects, hard cases, other codes."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from compare.engines import Progress
from compare.experiments.ablation import runner as effects
from compare.experiments.ablation.summary import summarise as summarise_effects
from compare.experiments.cost.timings import measured_on
from compare.experiments.scattering import summary as scattering
from compare.experiments.study.study import load
from compare.experiments.study.summary import REPORTED
from compare.experiments.study.summary import run as run_study
from compare.experiments.study.summary import summarise as summarise_study
from compare.figures.snapshots import make_snapshots
from compare.studies.hard_cases import make_study as make_hard_cases
from compare.studies.store import Pool
from compare.studies.summary import Summary

#: Share of the progress that each part takes.
PARTS = {"joints": 0.15, "studies": 0.2, "effects": 0.15, "hard cases": 0.5}


def sections(
    out: Path, pool: Pool | None, hard: bool, progress: Progress
) -> Iterator[dict[str, Any]]:
    """Yield the sections in the order of the page; points and figures are saved in `out`.

    hard : also put both engines to the hard cases.
    """
    folder, done = out / "studies", 0.0
    for name in scattering.TITLES:
        yield _joints(scattering.make_study(name, folder, None, True, pool))
    progress(done := done + PARTS["joints"])
    for i, name in enumerate(REPORTED, start=1):
        study = load(name)
        yield _study(summarise_study(folder, name, study, run_study(study, folder / name, pool)))
        progress(done + PARTS["studies"] * i / len(REPORTED))
    done += PARTS["studies"]
    found = effects.run(effects.reported(), out / "effects", pool)
    yield _effects(summarise_effects(out / "effects", found))
    progress(done := done + PARTS["effects"])
    if hard:
        yield _hard_cases(
            make_hard_cases(folder, pool, lambda x: progress(done + PARTS["hard cases"] * x))
        )
    yield _snapshots(out)


def _section(found: Summary, command: str, caption: str, **more: Any) -> dict[str, Any]:
    """Return what every section shows."""
    return {
        "id": found.name,
        "heading": found.title,
        "contents": found.title,
        "command": command,
        "sentences": found.sentences,
        "note": found.note,
        "failed": found.failed,
        "figure": found.figure,
        "caption": caption,
        "legend": found.legend,
        "table": found.table,
        **more,
    }


def _joints(found: Summary) -> dict[str, Any]:
    assert found.figure is not None
    return _section(
        found,
        f"jointwave study {found.name}",
        "Lines: the closed form; points: each solver. Beside them the largest error of the four "
        f"moduli over the cost of the run, measured on {measured_on()}. The command above computes "
        "more points.",
        more={"NetCDF": found.figure.file("nc")},
    )


def _study(found: Summary) -> dict[str, Any]:
    assert found.figure is not None
    of = f"of the {found.about} over all receivers" if found.about else "of the worst waveform"
    timed = f" Seconds are those of stepping, medians of repeats on {measured_on()}: compare their "
    return _section(
        found,
        f"jointwave study {found.name}",
        f"Errors are relative L2 norms {of}: numerical, from the exact solution of each curve's "
        "own model; modelling, of that solution from the finest physics; their sum counts, if all "
        "finer points of the curve also reach it. Colours are those of the models above."
        f"{timed + 'ratios.' if found.timed else ''}",
        id=f"study-{found.name}",
        heading=f"What accuracy costs. {found.title}",
        more={"NetCDF": found.figure.file("nc")},
    )


def _effects(found: Summary) -> dict[str, Any]:
    return _section(
        found,
        "jointwave effects",
        "Numbers refer to the scenes in the table; hollow points lie on or beyond the axes. "
        "Misfit: relative L2, rigid blocks without the effect compared with those with it. "
        f"Measured here: {found.about}; the command above uses every shipped pillar.",
        contents="Effects",
        legend="In the scene: ns per block-step that the effect adds to a scene with all its other "
        "effects; alone: to a scene without any. The two differ where effects share or compete for "
        "resources. Steps, ratio: steps with the effect over steps without it. Jointed rock: ns "
        "that it adds to a step of one degree of freedom of that engine. Minimum of repeats, on "
        f"{measured_on()}: compare their ratios.",
    )


def _hard_cases(found: Summary) -> dict[str, Any]:
    assert found.figure is not None
    return _section(
        found,
        "jointwave study stability",
        found.about,
        contents="Hard cases",
        more={"CSV of every cell": found.figure.folder / "stability-map.csv"},
    )


def _snapshots(out: Path) -> dict[str, Any]:
    found = make_snapshots(out)
    file = found.file.relative_to(out).as_posix()
    return {
        "id": "motion",
        "heading": f"The pillar in motion. {found.title}",
        "contents": "The pillar in motion",
        "command": "",
        "sentences": [],
        "failed": [],
        "note": "The blow compresses the pillar, bends it in two planes and twists it. The axial "
        "pulse, compression followed by tension, travels ahead at "
        f"{found.bar_speed:.0f}\u00a0m/s and is reflected by the fixed end as compression. Bending "
        "waves are slower and disperse, short waves ahead of long ones.",
        "figure": found.figure,
        "caption": "Rigid blocks, y to the right, seen from above the front, at the times on the "
        f"left. For ParaView: {file} beside this page.",
        "table": None,
    }
