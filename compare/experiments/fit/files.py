"""The files of a fit: a table, the fitted scene, and the figure of waveforms and residuals."""

import filecmp
import json
import shutil
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

import cases
from cases.errors import SceneError
from cases.kinds import AnyScene
from cases.schema.scene import Scene
from compare.experiments.fit.keys import CLOCK
from compare.experiments.fit.result import Fit, Fitted
from compare.experiments.fit.scene_text import scene_text
from compare.experiments.store import finite
from compare.figures.export import blank, save, write_csv
from compare.figures.overlays import UNITS
from compare.figures.style import GIVEN, style
from compare.runs.output import refuse_foreign, write, write_text

WIDTH, PANEL, AROUND = 7.5, 2.6, 0.8  # inches: the figure, a waveform with its residual, the rest
MOST_MARKS = 250  # samples that are drawn one by one
HEAD = "# Fitted by jointwave"


def draw(found: Fit) -> Figure:
    """Return the figure: each waveform as measured and fitted, and below it what is left."""
    count = len(found.waveforms)
    with blank(AROUND + count * PANEL, WIDTH) as figure:
        axes = figure.subplots(2 * count, sharex=True, height_ratios=[3, 1] * count, squeeze=False)
        for i, one in enumerate(found.waveforms):
            _draw_waveform(axes[2 * i, 0], axes[2 * i + 1, 0], one, found.solver, i)
        figure.align_ylabels()
        axes[-1, 0].set_xlabel("time (ms)")
        handles, labels = axes[0, 0].get_legend_handles_labels()
        figure.legend(
            handles, labels, loc="outside upper center", ncols=len(handles), frameon=False
        )
    return figure


def _draw_waveform(wave: Any, left: Any, one: Fitted, solver: str, i: int) -> None:
    place: Any = one.place
    factor, unit = UNITS[place.quantity]
    few = len(one.time) <= MOST_MARKS
    points = {"linestyle": "none", "marker": "o", "markersize": 2.0, "color": GIVEN[0].colour}
    line = {"color": style(solver).colour, "linewidth": 1.6, "linestyle": "-"}
    given = points if few else GIVEN[0].of_line()
    time = 1e3 * one.time
    wave.plot(time, factor * one.fitted, label=f"fitted ({solver})", zorder=2, **line)
    wave.plot(time, factor * one.measured, label="measured", **{**given, "zorder": 3})
    left.plot(time, factor * (one.measured - one.fitted), color=GIVEN[0].colour, linewidth=0.8)
    left.axhline(0, color="#bbbbbb", linewidth=0.6, zorder=1)
    shown = one.name if len(one.name) <= 28 else f"{one.name[:12]}…{one.name[-15:]}"
    where = place.heading
    misfit = f"misfit {one.before:.2%} before, {one.after:.2%} after"
    title = f"({chr(97 + i % 26)})  {where}, {shown}: {misfit}"
    wave.set_title(title.replace("$", r"\$"), pad=4)
    wave.set_ylabel(f"{place.quantity} ({unit})")
    left.set_ylabel(f"residual\n({unit})")
    reach = factor * float(np.abs(one.measured - one.fitted).max()) or 1.0
    left.set_ylim(-1.15 * reach, 1.15 * reach)
    for ax in (wave, left):
        ax.margins(x=0)


def write_fit(found: Fit, given: AnyScene, folder: Path) -> list[Path]:
    """Write fit.csv, fit.json, fitted.toml and fit-waveforms as SVG, PDF, PNG and CSV.

    given : the scene before. Raises SceneError where a scene that no fit wrote is in the way.
    """
    scene = folder / "fitted.toml"
    refuse_foreign(scene, (HEAD.encode(),))
    files = [
        write_csv(folder / "fit.csv", table(found), 12),
        write_text(folder / "fit.json", json.dumps(facts(found), indent=2) + "\n"),
        *_write_scene(found, given, scene),
    ]
    title = f"{found.scene.title}, fitted"
    drawn = save(draw(found), folder, "fit-waveforms", title, curves(found))
    return [*files, *drawn.drawings, drawn.file("csv")]


def table(found: Fit) -> pd.DataFrame:
    """Return the fitted keys with their intervals and correlations, SI."""
    rows = pd.DataFrame([e._asdict() for e in found.estimates])
    for j, e in enumerate(found.estimates):
        rows[f"correlation with {e.key}"] = found.correlation[:, j]
    return rows


def curves(found: Fit) -> pd.DataFrame:
    """Return every waveform, measured, fitted and what is left, over the scene's time, SI."""
    parts = [
        pd.DataFrame(
            {
                "curve": one.name,
                "place": str(one.place),
                "time (s)": one.time,
                "measured": one.measured,
                "fitted": one.fitted,
                "residual": one.measured - one.fitted,
            }
        )
        for one in found.waveforms
    ]
    return pd.concat(parts, ignore_index=True)


def facts(found: Fit) -> dict[str, Any]:
    """Return everything that is known of a fit, for a machine; null for what nothing bounds."""
    return {
        "title": found.scene.title,
        "variant": found.scene.name,
        "solver": found.solver,
        "confidence": 0.95,
        "keys": finite(found.estimates),
        "correlation": found.correlation.tolist(),
        "misfit_before": found.before,
        "misfit_after": found.after,
        "waveforms": [
            {
                "curve": one.name,
                "place": str(one.place),
                "samples": len(one.time),
                "independent_samples": one.independent,
                "misfit_before": one.before,
                "misfit_after": one.after,
            }
            for one in found.waveforms
        ],
        "trials": found.trials,
        "notes": found.notes,
        "set": found.settings,
    }


def _write_scene(found: Fit, given: AnyScene, path: Path) -> list[Path]:
    """Write the fitted scene so that it runs, with the files that it names beside it."""
    about = [f"{HEAD}: {found.solver}, misfit {found.before:.3%} before, {found.after:.3%} after."]
    for e in found.estimates:
        about.append(
            f"# {e.key} = {e.value:.6g} {e.unit}".rstrip()
            + f", 95 % within {e.low:.6g} to {e.high:.6g}, began at {e.start:.6g}"
            + (": added to the times of the files" if e.key == CLOCK else "")
        )
    about.append("")
    written = [write_text(path, "\n".join(about) + scene_text(found.scene))]
    folder = Path(given.where.partition(" [")[0]).parent
    scene = found.scene
    mesh = scene.numerics.continuum.mesh if isinstance(scene, Scene) else None
    names = dict.fromkeys([*(pulse.file for pulse in scene.pulses), mesh])
    for name in [name for name in names if name is not None]:
        there = path.parent / name
        if (folder / name).resolve() != there.resolve():
            if there.exists() and not filecmp.cmp(folder / name, there, shallow=False):
                allowed = "is another file and would be replaced: choose another --out"
                raise SceneError(str(there), "", None, allowed)
            written.append(write(there, partial(shutil.copyfile, folder / name)))
    cases.load(path)  # it runs
    return written
