"""`jointwave animate` and `jointwave view`: the wave in a scene by both engines."""

import os
import sys
from importlib.util import find_spec
from math import inf
from pathlib import Path

from jointwave.cases.errors import SceneError
from jointwave.cases.scene_type import AnyScene
from jointwave.compare.cli import terminal
from jointwave.compare.cli.commands import FRAMES, Animate, View
from jointwave.compare.cli.forecast import runs_of, show_forecasts
from jointwave.compare.cli.inputs import load, stored_in
from jointwave.compare.engines import label_of
from jointwave.compare.figures.animation.frame import PIXELS, Frame
from jointwave.compare.figures.animation.settings import quantities_of, settings_for
from jointwave.compare.figures.animation.snapshots import shown_engines, take, with_snapshots
from jointwave.compare.figures.animation.video import write_video
from jointwave.compare.figures.export import write_drawing
from jointwave.compare.runs import timings
from jointwave.compare.runs.output import FILMS, check_out
from jointwave.compare.runs.reuse import SNAPSHOTS


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
    with timings.measured("frames", scene.kind, count), terminal.progress("pictures") as advance:

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
        from jointwave.compare.figures.animation.window import open_window

        open_window(frame, i)
        return
    frame.show(i)
    write_drawing(path, frame.figure, scene.title, {"savefig.dpi": "figure"})
    _say(path, frame)


def _simulated(asked: Animate | View, scene: AnyScene, frames: int | None = None) -> Frame | None:
    """Return the frame of a scene's instants, by both engines; with `--dry-run` print what it would
    cost, and return None.

    frames : how many of a film; None: as many as the scene records snapshots, else FRAMES.
    """
    known = quantities_of(scene)
    if asked.quantity is not None and asked.quantity not in known:
        allowed = f"must be one of {', '.join(known)}, not {asked.quantity}"
        raise SceneError("--map", "", None, allowed)
    interval, stored = None, stored_in(asked)
    if frames is not None or scene.record.fields is None:
        interval = scene.time.duration / ((frames or FRAMES) - 1)
    if asked.dry:
        seen = scene if interval is None else with_snapshots(scene, interval)
        runs = runs_of(shown_engines(seen), seen, stored, "" if interval is None else SNAPSHOTS)
        drawn = round(scene.time.duration / (seen.record.fields or inf)) + 1
        drawn *= isinstance(asked, Animate)
        show_forecasts(runs, False, {"figures": 1, "frames": drawn})
        return None
    with terminal.progress("both engines") as advance:
        simulated = take(scene, interval, advance, stored)
    quantity = known[asked.quantity] if asked.quantity else None
    settings = settings_for(simulated.scene, simulated.found, asked.scale, quantity)
    return Frame(simulated, settings)


def _require_positive(key: str, value: float | None) -> None:
    if value is not None and not 0 < value < inf:
        raise SceneError(key, "", None, f"must be a positive number, not {value:g}")


def _path(asked: Animate | View, scene: AnyScene, suffix: str) -> Path:
    """Return --out, else a file that is called by the scene and its variant."""
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
    terminal.say(f"{path}: {engines}, displacements × {frame.settings.scale:,g}")
    for name, reason in shown.reasons.items():
        terminal.say(f"{label_of(name)} is not shown: {reason}")
