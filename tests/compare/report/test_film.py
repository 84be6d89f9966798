"""The film of a rock mass in space on the page."""

from PIL import Image, ImageSequence

from jointwave.compare.report.sections import FRAMES, film


def test_the_film_shows_all_instants_and_says_how_far_both_engines_are(tmp_path):
    (tmp_path / "figures").mkdir()
    found = film(tmp_path)["found"]
    said = [line.split(":")[0] for line in found.sentences]
    assert said == ["rigid blocks", "jointed rock"]
    with Image.open(*found.files) as images:
        frames = [one.convert("RGB").copy() for one in ImageSequence.Iterator(images)]
    assert len(frames) == FRAMES
    first, later = frames[0], frames[-1]
    assert first.size == later.size and first.tobytes() != later.tobytes()
