"""Films as MP4 or GIF, by the ffmpeg of imageio-ffmpeg."""

from collections.abc import Callable
from errno import EIO
from pathlib import Path
from subprocess import CalledProcessError
from typing import Any

import matplotlib
from imageio_ffmpeg import get_ffmpeg_exe
from matplotlib.animation import FFMpegWriter
from matplotlib.figure import Figure

from jointwave.cases.errors import SceneError
from jointwave.compare.engines import Progress
from jointwave.compare.runs.output import refuse_foreign, write

#: First bytes of the files, by suffix: MP4 begins with the size of its first box, `ftyp`.
BEGINS = {
    ".mp4": tuple(bytes([0, 0, 0, size]) + b"ftyp" for size in (0x14, 0x18, 0x1C, 0x20, 0x24)),
    ".gif": (b"GIF87a", b"GIF89a"),
}
DOTS = {".mp4": 100, ".gif": 75}  # pixels per inch; sizes are even, as H.264 with 4:2:0 needs
#: Every player shows H.264 in 4:2:0; its index comes first, so that it plays while it loads.
ENCODING = {".mp4": ["-crf", "20", "-pix_fmt", "yuv420p", "-movflags", "+faststart"], ".gif": []}
MOST_OF_A_GIF = 400  # frames, 2.3 MB each: one palette is made of all


def refuse(path: Path, count: int = 0) -> None:
    """Raise SceneError if `path` cannot be an animation with this many frames."""
    if path.suffix not in BEGINS:
        raise SceneError("--out", str(path), None, f"must end in {' or '.join(BEGINS)}")
    if path.suffix == ".gif" and count > MOST_OF_A_GIF:
        allowed = f"at most {MOST_OF_A_GIF} for a GIF, whose frames must all fit in memory"
        raise SceneError("--frames", "", None, f"{allowed}, not {count:,}; .mp4 takes more")
    refuse_foreign(path, BEGINS[path.suffix])


def write_video(
    path: Path,
    figure: Figure,
    show: Callable[[int], object],
    count: int,
    seconds: float,
    progress: Progress | None = None,
) -> Path:
    """Write `count` frames of a figure, lasting `seconds` in total; the suffix selects the format.

    show : of (frame), changes the figure to it.
    """
    refuse(path, count)
    codec = "libx264" if path.suffix == ".mp4" else "gif"

    def save(new: Path) -> None:
        rate: Any = count / seconds  # ffmpeg takes fractions
        writer = FFMpegWriter(rate, codec=codec, extra_args=ENCODING[path.suffix])
        with writer.saving(figure, str(new), figure.dpi):
            for i in range(count):
                show(i)
                writer.grab_frame()
                if progress is not None:
                    progress((i + 1) / count)

    with matplotlib.rc_context({"animation.ffmpeg_path": get_ffmpeg_exe()}):
        try:
            return write(path, save)
        except CalledProcessError as error:
            raise OSError(EIO, f"ffmpeg ended with code {error.returncode}", str(path)) from None
