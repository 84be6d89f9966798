"""The commands that draw: scenes, maps of results, waveforms and films."""

import json
import os
import re
import sys
from importlib.util import find_spec
from math import inf
from pathlib import Path

import xarray as xr
from matplotlib.figure import Figure as Drawing

from jointwave.cases.errors import SceneError
from jointwave.cases.scene_type import AnyScene
from jointwave.compare.cli.commands import FRAMES, Animate, Figure, Picture, View
from jointwave.compare.cli.forecast import runs_of, show_forecasts
from jointwave.compare.cli.inputs import curves_of, load, stored_in
from jointwave.compare.cli.terminal import progress, say
from jointwave.compare.engines import ENGINES, applies, label_of
from jointwave.compare.figures.animation import snapshots
from jointwave.compare.figures.animation.frame import PIXELS, Frame, open_window
from jointwave.compare.figures.animation.video import write_video
from jointwave.compare.figures.body_maps import maps_of, scene_of
from jointwave.compare.figures.charts import waveforms
from jointwave.compare.figures.charts.maps import draw_maps
from jointwave.compare.figures.drawing.scene import scene_figure
from jointwave.compare.figures.export import write_drawing
from jointwave.compare.figures.style import printed
from jointwave.compare.misfit.alignment import align_curve
from jointwave.compare.misfit.pairs import Comparison
from jointwave.compare.misfit.ranking import applicable
from jointwave.compare.runs import comparison, jobs, timings
from jointwave.compare.runs.output import FILMS, check_out
from jointwave.compare.runs.reuse import SNAPSHOTS
from jointwave.results.netcdf import load_netcdf


def picture(asked: Picture) -> None:
    """Draw a scene, or a map of its results."""
    source, map_of = Path(asked.scene), asked.quantity or "ppv"
    of_results = source.is_dir() or source.suffix == ".nc"
    name = re.sub(r"\.(toml|nc)$", "", source.resolve().name)
    path = asked.out or Path(f"{name}-{map_of}.png" if of_results else f"{name}.png")
    check_out(path)
    of_maps = {"--map": asked.quantity, "--time": asked.time, "--section": asked.section}
    if of_results:
        if asked.changes or asked.variant is not None:
            raise SceneError("--set, --variant", "", None, "are of a scene, not of a folder")
        if asked.explode is not None:
            raise SceneError("--explode", "", None, "is of a scene in space, not of a folder")
        drawn, title = _map(source, map_of, asked.time, asked.section)
    elif key := next((k for k, x in of_maps.items() if x is not None), None):
        run = f"jointwave run {asked.scene} --set record.fields=1e-3 --out FOLDER"
        raise SceneError(key, "", None, f"is of results: `{run}` first")
    else:
        scenes = load(asked)
        title = scenes[0].title
        if asked.explode is not None and not scenes[0].in_space:
            raise SceneError("--explode", "", None, f"is of a scene in space, not of {source}")
        shown = [Comparison(one) for one in scenes]
        drawn = scene_figure("scene", shown, asked.explode or 0.0).figure
    say(f"wrote {write_drawing(path, drawn, title)}")


def _map(
    folder: Path, quantity: str, time: float | None, section: str | None
) -> tuple[Drawing, str]:
    """Return the map of at most two results in a folder, and its title."""
    files = [folder / f"{name}.nc" for name in ENGINES] if folder.is_dir() else [folder]
    files = [file for file in files if file.exists()]
    if not files:
        raise SceneError(str(folder), "", None, "has no result of an engine, such as dem.nc")
    results = [_result(file) for file in files[:2]]
    one, other = (json.loads(results[k].attrs["scene"]) for k in (0, -1))
    aside = waveforms.ASIDE
    if differing := [key for key in one if key not in aside and one[key] != other.get(key)]:
        allowed = f"has results of two scenes, by {', '.join(differing)}: name one of the files"
        raise SceneError(str(folder), "", None, allowed)
    scene = scene_of(results[0])
    return draw_maps(maps_of(scene, results, quantity, time, section), scene), scene.title


def _result(file: Path) -> xr.Dataset:
    """Return a result from its file; raises SceneError for any other file."""
    try:
        found = load_netcdf(file)
        found.attrs["scene"], found.attrs["engine"], found.attrs["variant"]
    except MemoryError:
        raise
    except Exception:  # the libraries raise many kinds
        raise SceneError(str(file), "", None, "is damaged, or no result of `run`") from None
    return found


def figure(asked: Figure) -> None:
    """Solve a scene and draw its waveforms for a paper, or print the estimated cost."""
    check_out(asked.out)
    rc = printed(asked.width, asked.font_size)
    scenes, runs, wanted = load(asked), [], []
    if asked.engine or asked.model:
        runs = jobs.wanted([e.value for e in asked.engine], asked.model or [])
    curves = curves_of(asked.given, scenes, asked.strict)
    for one in scenes:
        chosen = [name for run in runs for name in jobs.names_of(*run, one)]
        wanted.append({name: applies(name, one) for name in chosen} or applicable(one))
    folder, found = stored_in(asked), []
    if asked.dry:
        both = zip(scenes, wanted, strict=True)
        planned = [run for one, of in both for run in runs_of(of, one, folder)]
        show_forecasts(planned, False, {"figures": len(scenes)})
        return
    for one, answers in zip(scenes, wanted, strict=True):
        with progress(one.name or one.title) as advance:
            drawn = comparison.solved(one, answers, advance, folder)
            drawn.besides += [align_curve(x, one, drawn.results, False) for x in curves]
            found.append(drawn)
    whole = waveforms.figure(found, asked.width, asked.font_size)
    say(f"wrote {write_drawing(asked.out, whole, scenes[0].title, rc)}")


def animate(asked: Animate) -> None:
    """Write a film of a scene."""
    _require_positive("--scale", asked.scale)
    _require_positive("--seconds", asked.seconds)
    (scene,) = load(asked, every=False)
    path = _path(asked, scene, ".mp4")
    check_out(path, FILMS)
    frame = _simulated(asked, scene, asked.frames)
    if frame is None:
        return
    count = len(frame.time)
    with timings.measured("frames", scene.kind, count), progress("pictures") as advance:

        def images():
            for i in range(count):
                yield frame.image(i)
                advance((i + 1) / count)

        write_video(path, images(), PIXELS, count / asked.seconds)
    _say(path, frame)


def view(asked: View) -> None:
    """Show a scene in a window, or write an image of one instant."""
    _require_positive("--scale", asked.scale)
    (scene,) = load(asked, every=False)
    end = scene.time.duration
    at = end / 2 if asked.time is None else asked.time
    if not 0 < at <= end:
        allowed = f"must be greater than 0 and at most time.duration = {end:g} s"
        raise SceneError("--time", "", None, f"{allowed}, not {at:g}")
    has_window = asked.out is None and _has_display() and find_spec("pyvista") is not None
    path = _path(asked, scene, ".png")
    if not has_window:
        check_out(path, (".png",))
    frame = _simulated(asked, scene)
    if frame is None:
        return
    i = int(abs(frame.time - at).argmin())
    if has_window:
        open_window(frame, i)
        return
    frame.show(i)
    write_drawing(path, frame.figure, scene.title, {"savefig.dpi": "figure"})
    _say(path, frame)


def _simulated(asked: Animate | View, scene: AnyScene, frames: int | None = None) -> Frame | None:
    """Return the frame of a scene by both engines; with `--dry-run` print the cost, return None.

    frames : number of frames; None: one per recorded snapshot, or FRAMES if none are recorded.
    """
    known = snapshots.quantities_of(scene)
    if asked.quantity is not None and asked.quantity not in known:
        allowed = f"must be one of {', '.join(known)}, not {asked.quantity}"
        raise SceneError("--map", "", None, allowed)
    interval, stored = None, stored_in(asked)
    if frames is not None or scene.record.fields is None:
        interval = scene.time.duration / ((frames or FRAMES) - 1)
    if asked.dry:
        seen = scene if interval is None else snapshots.with_snapshots(scene, interval)
        engines, suffix = snapshots.shown_engines(seen), SNAPSHOTS * (interval is not None)
        runs = [x._replace(may_fail=False) for x in runs_of(engines, seen, stored, suffix)]
        drawn = round(scene.time.duration / (seen.record.fields or inf)) + 1
        drawn *= isinstance(asked, Animate)
        show_forecasts(runs, False, {"figures": 1, "frames": drawn})
        return None
    with progress("both engines") as advance:
        simulated = snapshots.take(scene, interval, advance, stored)
    quantity = known[asked.quantity] if asked.quantity else None
    return Frame(simulated, asked.scale, quantity)


def _require_positive(key: str, value: float | None) -> None:
    if value is not None and not 0 < value < inf:
        raise SceneError(key, "", None, f"must be a positive number, not {value:g}")


def _path(asked: Animate | View, scene: AnyScene, suffix: str) -> Path:
    """Return --out, else a file named after the scene and its variant."""
    name = "-".join([Path(asked.scene).stem, *scene.name.split()])
    return asked.out or Path(f"{name}{suffix}")


def _has_display() -> bool:
    """Return whether a window can be opened."""
    if not sys.platform.startswith("linux"):
        return True
    return any(os.environ.get(name) for name in ("DISPLAY", "WAYLAND_DISPLAY"))


def _say(path: Path, frame: Frame) -> None:
    shown = frame.simulated
    engines = " and ".join(map(label_of, shown.found))
    say(f"{path}: {engines}, displacements × {frame.settings.scale:,g}")
    for name, reason in shown.reasons.items():
        say(f"{label_of(name)} is not shown: {reason}")
