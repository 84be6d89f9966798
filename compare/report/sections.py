"""Sections of the page besides scenes: studies, effects, hard cases, snapshots, a film."""

from collections.abc import Iterator
from itertools import chain
from pathlib import Path
from typing import Any

import pandas as pd

from jointwave import cases, dem
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.scene_type import pillar_of
from jointwave.compare.engines import Progress, label_of, solve
from jointwave.compare.figures.animation.frame import PIXELS, Frame, draw_snapshots
from jointwave.compare.figures.animation.snapshots import take
from jointwave.compare.figures.animation.video import write_video
from jointwave.compare.figures.export import save
from jointwave.compare.misfit.metrics import misfit
from jointwave.compare.report import peers
from jointwave.compare.runs.output import write_pvd
from jointwave.compare.scenes import find
from jointwave.compare.studies import effects, hard_cases
from jointwave.compare.studies.catalogue import experiment
from jointwave.compare.studies.experiment import Experiment, Summary
from jointwave.compare.studies.forecast import Run
from jointwave.compare.studies.scattering import TITLES
from jointwave.compare.studies.store import Pool
from jointwave.compare.studies.work_precision import REPORTED
from jointwave.compare.text import percent
from jointwave.results.snapshots import snapshots_of

APPENDIX = ("convergence", "uniform-chain")  # studies of time steps and elements only
BLOW = "beyond/eccentric-blow"  # the scene of the snapshots, and its changes
SEEN = {"record.fields": 5e-3, "time.duration": 0.035, "record.energy": False}
SLIDE, EXACT = "rock-mass/sliding-joint", "normal-incidence"  # the scene of the film, its solution
FRAMES, RATE = 41, 8  # of the film: number of frames, frames per second
DIAGRAMS = len(TITLES) + len(REPORTED) + 4  # effects, hard cases, snapshots, film
HARD = 0.5  # of the progress at which the hard cases start


def sections(
    out: Path, pool: Pool | None, hard: bool, others: pd.DataFrame | None, progress: Progress
) -> Iterator[dict[str, Any]]:
    """Yield the sections in the order of the page; points and figures are saved in `out`.

    hard : also run the hard cases. others : runs of other codes, shown after the first study.
    """
    folder, done = out / "studies", dict[str, Summary]()
    for name in TITLES:
        found = experiment(name, folder, brief=True).make(pool, None)
        yield section("joints", found, f"jointwave study {name}")
    studies = {name: experiment(name, folder) for name in REPORTED}
    # Timed ones last: they run in one process, with kernels that the others have compiled in all.
    for name in sorted(REPORTED, key=lambda name: studies[name].timed):
        done[name] = studies[name].make(pool, None)
        progress(HARD * len(done) / (len(REPORTED) + 1))
    for name in REPORTED:
        about = {"id": f"study-{name}", "appendix": name in APPENDIX}
        yield section("study", done[name], f"jointwave study {name}", **about)
        if name == REPORTED[0] and others is not None:
            found = peers.summarise(others, folder)
            yield section("peers", found, "make bench-peers", contents="Other codes")
    found = _effects(out).make(pool, None)
    yield section("effects", found, "jointwave effects beyond/paper-effects", contents="Effects")
    progress(HARD)
    if hard:
        made = experiment(hard_cases.NAME, folder).make
        found = made(pool, lambda x: progress(HARD + (1 - HARD) * x))
        about = {"contents": "Hard cases", "appendix": True}
        yield section("hard", found, f"jointwave study {hard_cases.NAME}", **about)
    progress(1.0)


def planned(out: Path) -> list[Run]:
    """Return the runs of the sections, with the hard cases."""
    names = *TITLES, *REPORTED, hard_cases.NAME
    studies = (experiment(name, out / "studies", brief=True).planned() for name in names)
    return [*chain(*studies), *_effects(out).planned()]


def _effects(out: Path) -> Experiment:
    return effects.experiment("Effects", effects.reported(), out / "effects")


def section(kind: str, found: Summary, command: str, **more: Any) -> dict[str, Any]:
    """Return the data of a section; kind : of its caption. more : its `id` and its `contents`
    entry, if not the name and title of the summary."""
    about = {"kind": kind, "found": found, "command": command, "appendix": False}
    return about | {"id": found.name, "contents": found.title} | more


def snapshots(out: Path) -> dict[str, Any]:
    """Simulate a pillar in motion, write its snapshots, and draw them."""
    scene = pillar_of(cases.load_variant(find(BLOW), "", SEEN))
    found = snapshots_of(dem.simulate(scene))
    assert found is not None
    file, shown = write_pvd(out / "fields" / "dem.pvd", found), found.since(1)
    figure = draw_snapshots("snapshots", scene, shown)
    table = pd.DataFrame(shown.stress, pd.Index(shown.time, name="time (s)"))
    table = table.add_prefix("axial stress of block ").add_suffix(" (Pa)").reset_index()
    drawn = save(figure, out / "figures", "snapshots", scene.title, table)
    note = (
        "The blow compresses the pillar, bends it in two planes and twists it. The axial pulse, "
        "compression followed by tension, travels ahead at "
        f"{calibrate(scene).bar_speed:.0f}\u00a0m/s and is reflected by the fixed end as "
        "compression. Bending waves are slower and disperse, short waves ahead of long ones."
    )
    title, place = f"The pillar in motion. {scene.title}", file.relative_to(out).as_posix()
    empty = pd.DataFrame(), (), (), ()
    about = Summary("motion", title, *empty, figure=drawn, note=note, about=place)
    return section("motion", about, "", contents="The pillar in motion")


def film(out: Path) -> dict[str, Any]:
    """Film a rock mass in space with both engines, with their misfits from the exact solution."""
    scene = cases.load_variant(find(SLIDE), "", {})
    simulated = take(scene, scene.time.duration / (FRAMES - 1))
    exact = solve(EXACT, simulated.scene)
    apart = [
        f"{label_of(name)}: {percent(misfit(result, exact), 2)} % from the {label_of(EXACT)}"
        for name, result in simulated.results.items()
    ]
    frame = Frame(simulated)
    images = (frame.image(i) for i in range(FRAMES))
    file = write_video(out / "figures" / "sliding-joint.gif", images, PIXELS, RATE)
    note = (
        "The wave comes from below and moves the rock oblique to both horizontal axes. The joint "
        "passes the shear that friction can carry and slips under the rest: the rock above moves "
        "less, and what does not pass is reflected."
    )
    table = pd.DataFrame()
    about = Summary("film", scene.title, table, apart, (), [file], note=note)
    return section("film", about, f"jointwave animate {SLIDE}", contents="A film in space")


#: The sections after these.
MOVING = {"motion": snapshots, "film": film}
