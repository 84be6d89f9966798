"""The snapshots of the report: one scene in space, by the rigid blocks."""

from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd

import cases
from cases.kinds import pillar_of
from cases.material.calibrate import calibrate
from compare.figures.export import Drawn, save
from compare.scenes import find
from results.snapshots import Snapshots, snapshots_of

SCENE = "beyond/eccentric-blow"  # and the changes that make its snapshots
CHANGES = {"record.fields": 5e-3, "time.duration": 0.035, "record.energy": False}


class SnapshotsSection(NamedTuple):
    """Snapshots of a whole pillar; file : shows them in ParaView. bar_speed : m/s."""

    title: str
    figure: Drawn
    file: Path
    bar_speed: float


def make_snapshots(out: Path) -> SnapshotsSection:
    """Simulate the scene, write its snapshots, and draw them as they are read back."""
    import dem
    from compare.figures.snapshots import draw_snapshots
    from compare.runs.field_files import read_pvd, write_pvd

    scene = pillar_of(cases.load_variant(find(SCENE), "", CHANGES))
    found = snapshots_of(dem.simulate_fields(scene))
    assert found is not None
    file = write_pvd(out / "fields" / "dem.pvd", found)
    shown = read_pvd(file).since(1)
    figure = draw_snapshots("snapshots", shown)
    drawn = save(figure, out / "figures", "snapshots", scene.title, _table(shown))
    return SnapshotsSection(scene.title, drawn, file, calibrate(scene).bar_speed)


def _table(s: Snapshots) -> pd.DataFrame:
    """Return where each block's centre is, and its axial stress, at every instant."""
    assert s.stress is not None
    moved = (s.points + s.displacement)[:, s.cells].mean(axis=2)  # [instant, cell, 3]
    count, cells = s.stress.shape
    columns = {"time (s)": np.repeat(s.time, cells), "block": np.tile(s.block, count)}
    columns |= {f"{axis} (m)": moved[..., k].ravel() for k, axis in enumerate("xyz")}
    return pd.DataFrame(columns | {"axial stress (Pa)": s.stress.ravel()})
