"""The page of a rock mass: its figures, its misfits and the verdicts on its engines."""

import re

import pytest

from compare.report.report import build

SQUARE = {
    "title": "One joint in a small square",
    "domain": {"size": [12.0, 12.0]},
    "time": {"duration": 0.02},
    "numerics": {"dem": {"block": 1.2}},
    "record": {"points": [[6.0, 9.0]], "joints": [[6.0, 6.0]]},
    "expect": {"continuum-jointed ~ oblique-joint": 0.01},
}
JOINT = {"dip": 20.0, "through": [6.0, 6.0], "normal_stiffness": 2e10, "shear_stiffness": 1e10}


@pytest.fixture(scope="module")
def found(once, one_joint, in_toml):
    """Return the page's text without what it holds and its styles, and its parts."""
    scene = one_joint(**SQUARE)
    scene["joint_sets"][0] |= JOINT

    def build_page(folder):
        file = folder / "square.toml"
        file.write_text(in_toml(scene), encoding="utf-8")
        return build(folder / "report", workers=1, scenes=[str(file)])

    report = once("rock-mass-page", build_page)
    text = report.file.read_text(encoding="utf-8")
    return re.sub(r"<(script|style)\b.*?</\1>", "", text, flags=re.DOTALL), report.page


def test_it_has_every_picture_and_nothing_of_pillars(found):
    text, page = found
    drawn = re.findall(r'<figure id="square-([a-z-]+)-figure"', text)
    assert drawn == ["scene", "waveforms", "spectra", "energy"]
    assert "pillar" not in text and page.rock_masses is None


def test_waveforms_have_every_solution_and_what_is_left_of_the_exact_one(found):
    """Both axes of the point, both of the joint's tractions."""
    text, _ = found
    curves = set(re.findall(r'id="square-waveforms-(\d+-\d+-[a-z-]+)"', text))
    for solution in ("dem", "continuum-jointed", "oblique-joint"):
        assert {name for name in curves if name.endswith(f"-{solution}")}, solution
    titles = ("velocity x at [6, 9] m", "velocity y at [6, 9] m", "traction n at", "traction s at")
    assert all(title in text for title in titles) and "less oblique-joint" in text


def test_engines_are_held_against_the_exact_solution(found):
    text, page = found
    (scene,) = page.overview.scenes
    for name in ("dem", "continuum-jointed"):
        assert scene.standings[name].finest == ("oblique-joint",)
        assert f"{scene.standings[name].verdict.word}</span>" in text
    assert scene.standings["continuum-jointed"].verdict.word == "agrees"
    (row,) = (
        row
        for rows in page.sections[0].misfits.groups.values()
        for row in rows
        if row[0] == "continuum-jointed ~ oblique-joint"
    )
    assert all(0 < float(cell.removeprefix("< ")) < 1 for cell in row[2:])
