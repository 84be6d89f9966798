"""Snapshots of the pillar seen from the side, coloured by its stress: a section of the page."""

from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import PolyCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

import cases
from cases.kinds import pillar_of
from cases.material.calibrate import calibrate
from compare.figures.animation.surface import Wave
from compare.figures.animation.view_settings import STRESS, ViewSettings, round_down
from compare.figures.export import Drawn, blank, save
from compare.figures.style import FIELD, WIDTH
from compare.scenes import find
from results.snapshots import Snapshots, snapshots_of

UP = np.array([1.0, 0.0, 0.0])
LARGEST = 0.8  # largest drawn displacement, of the pillar's thickness
MARGIN = 0.05  # of a strip's height, around it
LEFT, RIGHT = 0.75, 0.1  # inches beside the pillar
TOP, BOTTOM = 0.75, 0.45  # inches above and below


def draw_snapshots(name: str, s: Snapshots) -> Figure:
    """Return a figure of snapshots one below the other, with exaggerated displacements.

    Viewed along z; y is to the right and x up. The pillar of instant i is the SVG group NAME-i.
    """
    scale = exaggeration(s)
    wave = Wave(s, ViewSettings(UP, scale, 1.0, STRESS), float(np.ptp(s.points[:, 0])))
    stress = 1e-6 * wave.values
    peak = float(np.abs(stress).max()) or 1.0
    colour = ScalarMappable(Normalize(-peak, peak), FIELD)
    low, high = wave.reach()
    margin = MARGIN * (high[1] - low[1])
    low, high = low - margin, high + margin
    strip = (WIDTH - LEFT - RIGHT) * (high[1] - low[1]) / (high[0] - low[0])
    with blank(TOP + BOTTOM + len(s.time) * strip, laid_out=True) as figure:
        axes = _strips(figure, low, high, len(s.time))
        for i, ax in enumerate(axes):
            polygons, faces, _ = wave.drawn(i)
            pillar = PolyCollection(list(polygons), edgecolors="#333333", linewidths=0.4)
            pillar.set(facecolors=colour.to_rgba(stress[i, faces]), gid=f"{name}-{i}")
            ax.add_collection(pillar, autolim=False)
            ax.set_ylabel(f"{1e3 * s.time[i]:g} ms", rotation=0, ha="right", va="center")
        axes[-1].spines["bottom"].set_visible(True)
        axes[-1].tick_params(bottom=True)
        axes[-1].set_xlabel("y (m)")
        _add_colour_bar(figure, colour, scale)
    return figure


def exaggeration(s: Snapshots) -> float:
    """Return the exaggeration of displacements: 1, 2 or 5 times a power of ten; 1 without any."""
    largest = float(np.abs(s.displacement).max())
    return round_down(LARGEST * float(np.ptp(s.points[:, 0])) / largest) if largest else 1.0


def _strips(figure: Figure, low: np.ndarray, high: np.ndarray, count: int) -> list[Axes]:
    """Return the axes of strips from `low` to `high` (m), to the same scale in both directions."""
    total = figure.get_figheight()
    axes = figure.subplots(count, 1, sharex=True, sharey=True, squeeze=False)[:, 0]
    figure.subplots_adjust(
        LEFT / WIDTH, BOTTOM / total, 1 - RIGHT / WIDTH, 1 - TOP / total, hspace=0
    )
    axes[0].set(xlim=(low[0], high[0]), ylim=(low[1], high[1]))
    for ax in axes:
        ax.spines[:].set_visible(False)
        ax.tick_params(left=False, bottom=False, labelleft=False)
    return list(axes)


def _add_colour_bar(figure: Figure, colour: ScalarMappable, scale: float) -> None:
    inch = 1 / figure.get_figheight()
    bar = figure.add_axes((LEFT / WIDTH, 1 - 0.32 * inch, 0.3, 0.14 * inch))
    figure.colorbar(colour, cax=bar, orientation="horizontal")
    for part in bar.collections:
        part.set(rasterized=False, edgecolor="face")  # otherwise an image in the SVG
    bar.set_title("axial stress (MPa), compression positive", loc="left", pad=3)
    figure.text(1 - RIGHT / WIDTH, 1 - 0.3 * inch, f"displacements × {scale:,g}", ha="right")


SCENE = "beyond/eccentric-blow"  # and its changes for the snapshots
CHANGES = {"record.fields": 5e-3, "time.duration": 0.035, "record.energy": False}


class SnapshotsSection(NamedTuple):
    """Snapshots of a whole pillar; file : for ParaView. bar_speed : m/s."""

    title: str
    figure: Drawn
    file: Path
    bar_speed: float


def make_snapshots(out: Path) -> SnapshotsSection:
    """Simulate the scene, write its snapshots, and draw them as read back."""
    import dem
    from compare.runs.field_files import read_pvd, write_pvd

    scene = pillar_of(cases.load_variant(find(SCENE), "", CHANGES))
    found = snapshots_of(dem.simulate(scene))
    assert found is not None
    file = write_pvd(out / "fields" / "dem.pvd", found)
    shown = read_pvd(file).since(1)
    figure = draw_snapshots("snapshots", shown)
    drawn = save(figure, out / "figures", "snapshots", scene.title, _table(shown))
    return SnapshotsSection(scene.title, drawn, file, calibrate(scene).bar_speed)


def _table(s: Snapshots) -> pd.DataFrame:
    """Return the centre and the axial stress of each block at every instant."""
    assert s.stress is not None
    moved = (s.points + s.displacement)[:, s.cells].mean(axis=2)  # [instant, cell, 3]
    count, cells = s.stress.shape
    columns = {"time (s)": np.repeat(s.time, cells), "block": np.tile(s.block, count)}
    columns |= {f"{axis} (m)": moved[..., k].ravel() for k, axis in enumerate("xyz")}
    return pd.DataFrame(columns | {"axial stress (Pa)": s.stress.ravel()})
