"""Sequences of frames as MP4 or GIF, by the ffmpeg of imageio-ffmpeg."""

from collections.abc import Callable, Generator
from pathlib import Path
from typing import Any

import numpy as np

from cases.errors import SceneError
from compare.engines import Progress
from compare.runs.output import refuse_foreign, write

#: First bytes of the files, by suffix: MP4 begins with the size of its first box, `ftyp`.
BEGINS = {
    ".mp4": tuple(bytes([0, 0, 0, size]) + b"ftyp" for size in (0x14, 0x18, 0x1C, 0x20, 0x24)),
    ".gif": (b"GIF87a", b"GIF89a"),
}
DOTS = {".mp4": 100, ".gif": 75}  # pixels per inch; sizes are even, as H.264 with 4:2:0 needs

#: Options of ffmpeg. Every player supports H.264 in 4:2:0; its index comes first, so that it plays
#: before it is fully loaded; a GIF has one palette, computed from all frames.
ENCODING: dict[str, dict[str, Any]] = {
    ".mp4": {
        "codec": "libx264",
        "pix_fmt_out": "yuv420p",
        "output_params": ["-crf", "20", "-movflags", "+faststart"],
    },
    ".gif": {
        "codec": "gif",
        "pix_fmt_out": "pal8",
        "output_params": [
            "-filter_complex",
            "split[a][b];[a]palettegen=reserve_transparent=0[p];[b][p]paletteuse=dither=none",
        ],
    },
}

MOST_OF_A_GIF = 400  # frames, 2.3 MB each

Image = Callable[[int], np.ndarray]


def refuse(path: Path, count: int = 0) -> None:
    """Raise SceneError if `path` cannot be an animation with this many frames."""
    if path.suffix not in BEGINS:
        raise SceneError("--out", str(path), None, f"must end in {' or '.join(BEGINS)}")
    if path.suffix == ".gif" and count > MOST_OF_A_GIF:
        allowed = f"at most {MOST_OF_A_GIF} for a GIF, whose frames must all fit in memory"
        raise SceneError("--frames", "", None, f"{allowed}, not {count:,}; .mp4 takes more")
    refuse_foreign(path, BEGINS[path.suffix])


def write_video(
    path: Path, picture: Image, count: int, seconds: float, progress: Progress | None = None
) -> Path:
    """Write `count` frames, uint8 arrays [height, width, 4], lasting `seconds` in total.

    The suffix selects the format: .mp4 is H.264, of even sizes; .gif repeats endlessly.
    """
    refuse(path, count)

    def save(new: Path) -> None:
        writer = _writer(new, picture(0).shape, count / seconds)
        try:
            for i in range(count):
                writer.send(picture(i))
                if progress is not None:
                    progress((i + 1) / count)
        finally:
            writer.close()

    return write(path, save)


def _writer(path: Path, shape: tuple[int, ...], rate: float) -> Generator[None, np.ndarray, None]:
    """Return a generator that writes each frame sent to it, `rate` per second."""
    from imageio_ffmpeg import write_frames

    height, width, _ = shape
    writer = write_frames(
        str(path),
        (width, height),
        fps=rate,
        pix_fmt_in="rgba",
        quality=None,
        macro_block_size=2,
        ffmpeg_log_level="error",
        **ENCODING[path.suffix],
    )
    writer.send(None)
    return writer
