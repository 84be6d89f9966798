"""Pictures one after the other as a file: MP4 by ffmpeg, which imageio-ffmpeg brings, or GIF."""

from collections.abc import Callable
from pathlib import Path

import numpy as np

from cases.errors import SceneError
from compare.engines import Progress
from compare.output import refuse_foreign, write

#: How our files begin, by their ending: MP4 with the size of its first box, `ftyp`.
BEGINS = {
    ".mp4": tuple(bytes([0, 0, 0, size]) + b"ftyp" for size in (0x14, 0x18, 0x1C, 0x20, 0x24)),
    ".gif": (b"GIF87a", b"GIF89a"),
}
DOTS = {".mp4": 100, ".gif": 75}  # pixels an inch; every size is even, as H.264 with 4:2:0 needs

Picture = Callable[[int], np.ndarray]


def refuse(path: Path) -> None:
    """Raise SceneError where `path` can be no animation of ours."""
    if path.suffix not in BEGINS:
        raise SceneError("--out", str(path), None, f"must end in {' or '.join(BEGINS)}")
    refuse_foreign(path, BEGINS[path.suffix])


def write_video(
    path: Path, picture: Picture, count: int, seconds: float, progress: Progress | None = None
) -> Path:
    """Write `count` pictures, uint8 arrays [height, width, 4], that last so many seconds.

    The ending says how: .mp4 is H.264, 8 bits, 4:2:0, which every player shows; .gif goes round.
    """
    refuse(path)

    def shown(i: int) -> np.ndarray:
        if progress is not None:
            progress(i / count)
        return picture(i)

    save = _save_gif if path.suffix == ".gif" else _save_mp4
    return write(path, lambda new: save(new, shown, count, seconds))


def _save_mp4(path: Path, picture: Picture, count: int, seconds: float) -> None:
    from imageio_ffmpeg import write_frames

    height, width, _ = picture(0).shape
    film = write_frames(
        str(path),
        (width, height),
        pix_fmt_in="rgba",
        pix_fmt_out="yuv420p",
        fps=count / seconds,
        codec="libx264",
        quality=None,
        macro_block_size=2,
        output_params=["-crf", "20", "-movflags", "+faststart"],
    )
    film.send(None)
    try:
        for i in range(count):
            film.send(picture(i))
    finally:
        film.close()


def _save_gif(path: Path, picture: Picture, count: int, seconds: float) -> None:
    from PIL import Image

    pictures = [Image.fromarray(picture(i)[..., :3]) for i in range(count)]
    palette = pictures[count // 2].quantize(256)
    few = [p.quantize(palette=palette, dither=Image.Dither.NONE) for p in pictures]
    ends = np.round(100 * seconds * np.arange(count + 1) / count)  # its clock has hundredths
    durations = (10 * np.diff(ends)).astype(int).tolist()
    few[0].save(path, save_all=True, append_images=few[1:], duration=durations, loop=0)
