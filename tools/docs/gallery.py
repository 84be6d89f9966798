"""Run the code of the gallery's pages (of NAME ...), and update their pictures and scenes."""

import re
import shutil
import subprocess
import sys
from contextlib import chdir
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

from PIL import Image, ImageSequence

ROOT = Path(__file__).parents[2]
GALLERY = ROOT / "docs" / "gallery"
CODE = re.compile(r"```python\n(.*?)```", re.DOTALL)
SCENE = re.compile(r"```toml title=\"([^\"]+)\"\n(.*?)```", re.DOTALL)
SHIPPED = re.compile(r"is shipped as `([^`]+)`")
PICTURE = re.compile(r"!\[[^\]]*\]\(([^)]+)\)")
COMMAND = re.compile(r"^    jointwave (.+)$", re.MULTILINE)
COLOURS, SMALL = 128, (640, 360)  # size of the palette; size of a film, pixels


class Page(NamedTuple):
    """A page: its scene's file name, the scene as shown and as stored, its code, commands and
    pictures."""

    path: Path
    file: str
    shown: str
    kept: str
    code: str
    commands: list[str]
    pictures: list[str]


def read(path: Path) -> Page:
    """Return a page."""
    text = path.read_text(encoding="utf-8")
    ((file, shown),), (code,) = SCENE.findall(text), CODE.findall(text)
    shipped = SHIPPED.search(text)
    kept = ROOT / "cases" / f"{shipped[1]}.toml" if shipped else GALLERY / file
    found = COMMAND.findall(text), PICTURE.findall(text)
    return Page(path, file, shown, kept.read_text(), code, *found)


def run(page: Page, folder: Path) -> None:
    """Run a page's code and commands in a folder with its scene."""
    (folder / page.file).write_text(page.kept, encoding="utf-8")
    with chdir(folder):
        exec(compile(page.code, str(page.path), "exec"), {})
    for words in map(str.split, page.commands):
        subprocess.run([sys.executable, "-m", "jointwave", *words], check=True, cwd=folder)


def make(page: Page, folder: Path) -> None:
    """Update a page's scene and pictures."""
    whole, text = f'```toml title="{page.file}"\n{page.kept}```', page.path.read_text()
    page.path.write_text(SCENE.sub(lambda _: whole, text))
    run(page, folder)
    for made in (folder / name for name in page.pictures):
        with Image.open(made) as drawn:
            size, film = drawn.size, {}
            if made.suffix == ".gif":
                size, film = (
                    SMALL,
                    {"save_all": True, "duration": drawn.info["duration"], "loop": 0},
                )
            found = [one.convert("RGB").resize(size) for one in ImageSequence.Iterator(drawn)]
        palette = found[len(found) // 2].quantize(COLOURS, Image.Quantize.FASTOCTREE)
        first, *rest = (one.quantize(palette=palette, dither=Image.Dither.NONE) for one in found)
        first.save(made, optimize=True, **film, **({"append_images": rest} if rest else {}))
        shutil.copy(made, GALLERY)


if __name__ == "__main__":
    for path in sorted(GALLERY.glob("*.md")):
        if path.stem != "index" and path.stem in (sys.argv[1:] or path.stem):
            with TemporaryDirectory() as place:
                make(read(path), Path(place))
