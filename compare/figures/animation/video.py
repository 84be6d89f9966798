"""Films as MP4 or GIF, written by the ffmpeg of imageio-ffmpeg."""

from collections.abc import Iterable
from contextlib import suppress
from errno import EIO
from fractions import Fraction
from pathlib import Path
from subprocess import PIPE, Popen

import numpy as np
from imageio_ffmpeg import get_ffmpeg_exe

from jointwave.cases.errors import SceneError
from jointwave.compare.runs.output import FILMS, check_out, write

#: H.264 in 4:2:0, which every player shows, with the index first, so that it plays while loading.
#: Each frame of a GIF has its palette, so that ffmpeg need not hold all frames in memory.
PALETTES = "split[a][b];[a]palettegen=stats_mode=single[p];[b][p]paletteuse=new=1:dither=none"
ENCODING = {
    ".mp4": ["-c:v", "libx264", "-crf", "20", "-pix_fmt", "yuv420p", "-movflags", "+faststart"],
    ".gif": ["-filter_complex", PALETTES],
}
#: Largest frame rates, per second; the time unit of a GIF is a hundredth of a second.
MOST = {".mp4": 1000.0, ".gif": 100.0}


def write_video(
    path: Path, images: Iterable[np.ndarray], size: tuple[int, int], rate: float
) -> Path:
    """Write images, uint8 arrays [height, width, 4], as MP4 or GIF by the path's suffix.

    size : width and height, even. rate : images per second; raises SceneError above `MOST`.
    """
    check_out(path, FILMS)
    if rate > (most := MOST[path.suffix]):
        allowed = f"{rate:.4g} frames a second, at most {most:g}: --frames, --seconds"
        raise SceneError(str(path), "", None, allowed)
    raw = f"-f rawvideo -pix_fmt rgba -s {size[0]}x{size[1]} -r {Fraction(rate)} -i -".split()

    def save(new: Path) -> None:
        command = [get_ffmpeg_exe(), "-y", "-v", "error", *raw, *ENCODING[path.suffix], str(new)]
        with Popen(command, stdin=PIPE) as ffmpeg:
            assert ffmpeg.stdin is not None
            with suppress(BrokenPipeError):  # the return code is checked below
                for image in images:
                    ffmpeg.stdin.write(image.tobytes())
        if ffmpeg.returncode:
            raise OSError(EIO, f"ffmpeg ended with code {ffmpeg.returncode}", str(path))

    return write(path, save)
