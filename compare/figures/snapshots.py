"""Snapshots of a pillar in space, coloured by its stress: a section of the page."""

from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from jointwave import cases, dem
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.scene_type import pillar_of
from jointwave.cases.schema.scene import Scene
from jointwave.compare.figures.animation.bodies import OBLIQUE, BodyView, body_of, colours_of
from jointwave.compare.figures.animation.settings import settings_for
from jointwave.compare.figures.export import Drawn, blank, save
from jointwave.compare.runs.field_files import write_pvd
from jointwave.compare.scenes import find
from jointwave.results.snapshots import Snapshots, snapshots_of

HEAD, STRIP = 0.7, 0.95  # inches above, and of a pillar
SCENE = "beyond/eccentric-blow"  # and its changes for the snapshots
CHANGES = {"record.fields": 5e-3, "time.duration": 0.035, "record.energy": False}


class SnapshotsSection(NamedTuple):
    """Snapshots of a whole pillar; file : for ParaView. bar_speed : m/s."""

    title: str
    figure: Drawn
    file: Path
    bar_speed: float


def make_snapshots(out: Path) -> SnapshotsSection:
    """Simulate the scene, write its snapshots, and draw them."""
    scene = pillar_of(cases.load_variant(find(SCENE), "", CHANGES))
    found = snapshots_of(dem.simulate(scene))
    assert found is not None
    file = write_pvd(out / "fields" / "dem.pvd", found)
    shown = found.since(1)
    figure = draw_snapshots("snapshots", scene, shown)
    drawn = save(figure, out / "figures", "snapshots", scene.title, _table(shown))
    return SnapshotsSection(scene.title, drawn, file, calibrate(scene).bar_speed)


def draw_snapshots(name: str, scene: Scene, s: Snapshots) -> Figure:
    """Return a figure of snapshots one below the other, with exaggerated displacements.

    The pillar of instant i is the SVG group NAME-i.
    """
    settings = settings_for(scene, {"": s})
    body = body_of(s, scene, settings)
    colours = colours_of([body.values], settings.quantity.sign)
    with blank(HEAD + STRIP * len(s.time)) as figure:
        axes = figure.subplots(len(s.time), 1, squeeze=False)[:, 0]
        for i, (ax, time) in enumerate(zip(axes, s.time, strict=True)):
            view = BodyView(ax, body, colours, OBLIQUE)
            view.show(i)
            view.faces.set_gid(f"{name}-{i}")
            ax.set(xticks=[], yticks=[], frame_on=False)
            ax.set_ylabel(f"{1e3 * time:g} ms", rotation=0, ha="right", va="center")
        axes[-1].set_xlabel(f"y to the right; {settings.caption}")
        label = settings.quantity.label
        figure.colorbar(colours, ax=axes, label=label, location="top", shrink=0.4, aspect=30)
    return figure


def _table(s: Snapshots) -> pd.DataFrame:
    """Return the centre and the axial stress of each block at every instant."""
    assert s.stress is not None
    moved = (s.points + s.displacement)[:, s.cells].mean(axis=2)  # [instant, cell, 3]
    count, cells = s.stress.shape
    columns = {"time (s)": np.repeat(s.time, cells), "block": np.tile(s.block, count)}
    columns |= {f"{axis} (m)": moved[..., k].ravel() for k, axis in enumerate("xyz")}
    return pd.DataFrame(columns | {"axial stress (Pa)": s.stress.ravel()})
