"""The files of a fit: a table, the fitted scene, and the figure of waveforms and residuals."""

import filecmp
import json
import shutil
from functools import partial
from pathlib import Path
from typing import Any

import pandas as pd

import cases
from cases.errors import SceneError
from cases.kinds import AnyScene
from cases.schema.scene import Scene
from compare.experiments.fit.diagram import draw
from compare.experiments.fit.keys import CLOCK
from compare.experiments.fit.result import Fit
from compare.experiments.fit.scene_text import scene_text
from compare.experiments.store import finite
from compare.figures.export import save, write_csv
from compare.runs.output import refuse_foreign, write, write_text

HEAD = "# Fitted by jointwave"


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
