"""The gallery: every page's scene is the one that is kept, its lines run and draw its pictures."""

from pathlib import Path

import pytest
from PIL import Image

ROOT = Path(__file__).parents[1]
GALLERY = ROOT / "docs" / "gallery"
NAMES = sorted(path.stem for path in GALLERY.glob("*.md") if path.stem != "index")
#: Pages of rock masses by both engines: ten seconds to a minute each.
SLOW = {"tunnel", "blast-hole", "slope", "layers"}
LARGEST, FILM = 80_000, 400_000  # bytes of a picture, and of a film


@pytest.fixture
def gallery(modules_of):
    return modules_of(ROOT / "tools" / "docs")("gallery")


def test_there_are_ten_scenes(gallery):
    index = (GALLERY / "index.md").read_text(encoding="utf-8")
    assert len(NAMES) == 10 and all(f"({name}.md)" in index for name in NAMES)


@pytest.mark.parametrize("name", NAMES)
def test_a_page_shows_the_scene_that_is_kept(gallery, name):
    page = gallery.read(GALLERY / f"{name}.md")
    assert page.shown == page.kept and f'jw.load("{page.file}"' in page.code
    drawn = {GALLERY / one for one in page.pictures}
    assert all(one.stat().st_size < (FILM if one.suffix == ".gif" else LARGEST) for one in drawn)


@pytest.mark.parametrize(
    "name", [pytest.param(one, marks=pytest.mark.slow if one in SLOW else ()) for one in NAMES]
)
def test_the_lines_of_a_page_draw_its_pictures(gallery, name, tmp_path):
    """As large as those that are kept."""
    page = gallery.read(GALLERY / f"{name}.md")
    gallery.run(page, tmp_path)
    for one in (one for one in page.pictures if one.endswith(".png")):
        with Image.open(tmp_path / one) as made, Image.open(GALLERY / one) as kept:
            assert made.size == kept.size
            assert len(made.convert("RGB").getcolors(1_000_000)) > 20
