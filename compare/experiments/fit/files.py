"""The files of a fit: a table, the fitted scene as text, and the figure with residuals."""

import filecmp
import json
import shutil
from functools import partial
from pathlib import Path
from typing import Any

import pandas as pd
from matplotlib.figure import Figure

import cases
from cases.errors import SceneError
from cases.kinds import AnyScene
from cases.schema.scene import Scene
from compare.experiments.fit.keys import CLOCK
from compare.experiments.fit.result import Fit
from compare.experiments.store import finite
from compare.figures.charts import static
from compare.figures.charts.chart import Chart, Entry, short
from compare.figures.export import save, write_csv
from compare.figures.overlays import Overlay, Trace, subplots_of
from compare.figures.style import given_style, style
from compare.runs.output import refuse_foreign, write, write_text

NAME = "fit-waveforms"
HEIGHT = 1.6  # inches of a waveform
HEAD = "# Fitted by jointwave"


def draw(found: Fit) -> Figure:
    """Return the figure: each waveform as measured and fitted, and below it the residual."""
    cells, fitted = [], f"fitted ({found.solver})"
    below = style(found.solver)._replace(width=3.2, dashes="-", order=0)
    for i, one in enumerate(found.waveforms):
        drawn, marker = given_style(0, len(one.time))
        place: Any = one.place
        measured, curve = (pd.Series(values, one.time) for values in (one.measured, one.fitted))
        traces = [
            Trace(fitted, below, curve, None, "fitted"),
            Trace("measured", drawn, measured, measured - curve, "measured", marker),
        ]
        misfit = f"misfit {one.before:.2%} before, {one.after:.2%} after"
        heading = f"{place.heading}, {short(one.name)}: {misfit}"
        overlay = Overlay(heading, place.quantity, 0.0, traces, fitted)
        cells.append([subplots_of(overlay, str(i), HEIGHT, "")])
    entries = [Entry(t.name, t.name, t.style, t.marker) for t in traces]
    return static.draw(NAME, Chart(cells, "time (ms)", {"": entries}, is_lettered=True))


def write_fit(found: Fit, given: AnyScene, folder: Path) -> list[Path]:
    """Write fit.csv, fit.json, fitted.toml and fit-waveforms as SVG, PDF, PNG and CSV.

    given : the scene before. Raises SceneError if it would overwrite a scene not of a fit.
    """
    scene = folder / "fitted.toml"
    refuse_foreign(scene, (HEAD.encode(),))
    files = [
        write_csv(folder / "fit.csv", table(found), 12),
        write_text(folder / "fit.json", json.dumps(facts(found), indent=2) + "\n"),
        *_write_scene(found, given, scene),
    ]
    title = f"{found.scene.title}, fitted"
    drawn = save(draw(found), folder, NAME, title, curves(found))
    return [*files, *drawn.drawings, drawn.file("csv")]


def table(found: Fit) -> pd.DataFrame:
    """Return the fitted keys with their intervals and correlations, SI."""
    rows = pd.DataFrame([e._asdict() for e in found.estimates])
    for j, e in enumerate(found.estimates):
        rows[f"correlation with {e.key}"] = found.correlation[:, j]
    return rows


def curves(found: Fit) -> pd.DataFrame:
    """Return every waveform, measured, fitted and its residual, over the scene's time, SI."""
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
    """Return a fit as JSON; null for unbounded values."""
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
    """Write the fitted scene, runnable, with the files to which it refers beside it."""
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
                allowed = "exists and was not written by a fit: choose another --out"
                raise SceneError(str(there), "", None, allowed)
            written.append(write(there, partial(shutil.copyfile, folder / name)))
    cases.load(path)  # it runs
    return written


def scene_text(scene: AnyScene) -> str:
    """Return a scene as the text of a scene file, defaults left out."""
    told = scene.model_dump(mode="json", exclude_defaults=True, exclude_none=True)
    told.pop("name", None)
    return "\n".join(_lines("", told)) + "\n"


def _lines(path: str, table: dict[str, Any]) -> list[str]:
    """Return a table's own keys, then the tables in it under headings."""
    inner = {k: v for k, v in table.items() if isinstance(v, dict)}
    many = {k: v for k, v in table.items() if isinstance(v, list) and v and isinstance(v[0], dict)}
    lines = [
        f"{_key(k)} = {_value(v)}" for k, v in table.items() if k not in inner and k not in many
    ]
    for key, one in inner.items():
        name = f"{path}{_key(key)}"
        lines += ["", f"[{name}]", *_lines(f"{name}.", one)]
    for key, several in many.items():
        name = f"{path}{_key(key)}"
        for one in several:
            lines += ["", f"[[{name}]]", *_lines(f"{name}.", one)]
    return lines


def _key(name: str) -> str:
    return name if name.replace("_", "").isalnum() and name.isascii() else _value(name)


def _value(value: Any) -> str:
    if isinstance(value, list):
        return f"[{', '.join(map(_value, value))}]"
    # JSON's texts and numbers are valid TOML, except for one control character.
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
