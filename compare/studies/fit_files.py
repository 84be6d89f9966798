"""The files of a fit: a table, the fitted scene as text, and the figure with residuals."""

import filecmp
import json
import shutil
from functools import partial
from pathlib import Path
from typing import Any

import pandas as pd
from matplotlib.figure import Figure

from jointwave import cases
from jointwave.cases.errors import SceneError
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.schema.scene import Scene
from jointwave.compare.figures.export import blank, save
from jointwave.compare.figures.style import style
from jointwave.compare.runs.output import refuse_foreign, write, write_csv, write_text
from jointwave.compare.studies.fit import Fit, Fitted
from jointwave.compare.studies.fit_keys import CLOCK

NAME = "fit-waveforms"
HEIGHT = 2.4  # inches of a waveform and its residual
HEAD = "# Fitted by jointwave"


def write_fit(found: Fit, given: AnyScene, folder: Path) -> list[Path]:
    """Write fit.csv, fitted.toml and fit-waveforms as SVG, PDF, PNG and CSV.

    given : the scene before. Raises SceneError if it would overwrite a scene not of a fit.
    """
    scene = folder / "fitted.toml"
    refuse_foreign(scene, (HEAD.encode(),))
    table = pd.DataFrame(found.estimates)
    for j, e in enumerate(found.estimates):
        table[f"correlation with {e.key}"] = found.correlation[:, j]
    curves = pd.concat(map(_curve, found.waveforms), ignore_index=True)
    files = [
        write_csv(folder / "fit.csv", table, 12),
        *_write_scene(found, given, scene),
    ]
    drawn = save(draw(found), folder, NAME, f"{found.scene.title}, fitted", curves)
    return [*files, *drawn.drawings, drawn.file("csv")]


def draw(found: Fit) -> Figure:
    """Return the figure: each waveform as measured and fitted, and below it the residual."""
    count = len(found.waveforms)
    with blank(HEIGHT * count) as figure:
        axes = figure.subplots(2 * count, sharex=True, height_ratios=[3, 1] * count)
        for i, one in enumerate(found.waveforms):
            above, below = axes[2 * i : 2 * i + 2]
            time = 1e3 * one.time
            above.plot(time, one.measured, ".", color="#000000", ms=3, label="measured")
            colour = style(found.solver).colour
            above.plot(time, one.fitted, color=colour, label=f"fitted ({found.solver})")
            below.plot(time, one.measured - one.fitted, color="#000000", linewidth=0.8)
            misfit = f"misfit {one.before:.2%} before, {one.after:.2%} after"
            name = one.name if len(one.name) < 32 else f"{one.name[:28]}..."
            above.set_title(f"{one.place.words}, {name}: {misfit}".replace("$", r"\$"), fontsize=8)
            above.set_ylabel(one.place.quantity)
            below.set_ylabel("residual")
        axes[0].legend(frameon=False)
        axes[-1].set_xlabel("time (ms)")
        figure.align_ylabels()
    return figure


def scene_text(scene: AnyScene) -> str:
    """Return a scene as the text of a scene file, defaults left out."""
    told = scene.model_dump(mode="json", exclude_defaults=True, exclude_none=True)
    told.pop("name", None)
    tables = {key: value for key, value in told.items() if isinstance(value, dict)}
    lines = [f"{key} = {_value(value)}" for key, value in told.items() if key not in tables]
    for heading, table in tables.items():
        lines += ["", f"[{heading}]", *(f"{_key(k)} = {_value(v)}" for k, v in table.items())]
    return "\n".join(lines) + "\n"


def _key(name: str) -> str:
    return name if name.replace("_", "").isalnum() and name.isascii() else _value(name)


def _value(value: Any) -> str:
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{_key(k)} = {_value(v)}" for k, v in value.items()) + " }"
    if isinstance(value, list):
        tables = any(isinstance(one, dict) for one in value)
        between, end = (",\n    ", "\n") if tables else (", ", "")
        return f"[{between[1:] * tables}{between.join(map(_value, value))}{end}]"
    # JSON's texts and numbers are valid TOML, except for one control character.
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")


def _curve(one: Fitted) -> pd.DataFrame:
    """Return a waveform, measured, fitted and its residual, over the scene's time, SI."""
    return pd.DataFrame(
        {
            "curve": one.name,
            "place": str(one.place),
            "time (s)": one.time,
            "measured": one.measured,
            "fitted": one.fitted,
            "residual": one.measured - one.fitted,
        }
    )


def _write_scene(found: Fit, given: AnyScene, path: Path) -> list[Path]:
    """Write the fitted scene, runnable, with the files to which it refers beside it."""
    about = [f"{HEAD}: {found.solver}, misfit {found.before:.3%} before, {found.after:.3%} after."]
    for e in found.estimates:
        about.append(
            f"# {e.key} = {e.value:.6g}, 95 % within {e.low:.6g} to {e.high:.6g}, "
            f"began at {e.start:.6g}"
            + (": added to the times of the files" if e.key == CLOCK else "")
        )
    written = [write_text(path, "\n".join([*about, scene_text(found.scene)]))]
    folder, scene = Path(given.where.partition(" [")[0]).parent, found.scene
    mesh = scene.numerics.continuum.mesh if isinstance(scene, Scene) else None
    for name in filter(None, dict.fromkeys([*(pulse.file for pulse in scene.pulses), mesh])):
        there = path.parent / name
        if (folder / name).resolve() != there.resolve():
            if there.exists() and not filecmp.cmp(folder / name, there, shallow=False):
                allowed = "exists and was not written by a fit: choose another --out"
                raise SceneError(str(there), "", None, allowed)
            written.append(write(there, partial(shutil.copyfile, folder / name)))
    cases.load(path)  # it runs
    return written
