"""The scenes of a report, and their names on the page."""

import pytest

from jointwave.cases.errors import SceneError
from jointwave.compare.report.report import build
from jointwave.compare.report.scenes import PAPER, ROCK_MASSES, asked_for


def test_without_names_it_is_the_papers_figures_in_order():
    assert [one.number for one in asked_for(())] == list(range(2, 11))
    assert asked_for(())[0].label == "fig. 2"


def test_rock_masses_beside_the_paper_are_shipped_and_no_figures_of_it():
    found = asked_for(ROCK_MASSES)
    assert [one.label for one in found] == ["one-joint"]
    assert not {one.name for one in found} & {one.name for one in asked_for(())}


def test_every_scene_has_a_name_of_its_own_that_is_fit_for_files(tmp_path):
    files = [tmp_path / "a" / "my pillar.toml", tmp_path / "b" / "my pillar.toml"]
    files += [tmp_path / "overview.toml", tmp_path / "岩.toml"]
    for file in files:
        file.parent.mkdir(exist_ok=True)
        file.write_text((PAPER / "fig-03.toml").read_text())
    found = asked_for([*map(str, files), str(files[0]), "guo-li-2002/fig-03"])
    names = [one.name for one in found]
    assert names == ["my-pillar", "my-pillar-2", "overview-2", "scene-2", "fig-03"]
    assert [one.number for one in found] == [None, None, None, None, 3]


def test_a_copy_of_a_figure_of_the_paper_makes_no_claims_of_the_paper(tmp_path):
    copy = tmp_path / "fig-03.toml"
    copy.write_text((PAPER / "fig-03.toml").read_text())
    assert asked_for([str(copy)])[0].number is None


def test_a_scene_that_is_not_there_is_said_before_anything_is_written(tmp_path):
    with pytest.raises(SceneError, match=r"none\.toml"):
        build(tmp_path / "page", scenes=["none.toml"])
    assert not (tmp_path / "page").exists()
