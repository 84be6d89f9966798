"""The page of a rock mass: its figures, its misfits and the verdicts on its engines."""

import re

import pandas as pd
import pytest

from jointwave.compare.report.report import build


@pytest.fixture(scope="module")
def found(once, one_joint, in_toml):
    """Return the page's text without pictures and style, and the report."""
    scene = one_joint(
        title="One joint in a small square",
        domain={"size": [12.0, 12.0]},
        time={"duration": 0.02},
        numerics={"dem": {"block": 1.2}},
        record={"points": [[6.0, 9.0]], "joints": [[6.0, 6.0]]},
        expect={"continuum-jointed ~ oblique-joint": 0.01},
    )
    stiff = {"normal_stiffness": 2e10, "shear_stiffness": 1e10}
    scene["joint_sets"][0] |= stiff | {"dip": 20.0, "through": [6.0, 6.0]}

    def build_page(folder):
        (file := folder / "square.toml").write_text(in_toml(scene))
        return build(folder / "report", workers=1, scenes=[str(file)])

    report = once("rock-mass-page", build_page)
    text = report.file.read_text(encoding="utf-8")
    return re.sub(r'<style>.*?</style>|src="[^"]*"', "", text, flags=re.DOTALL), report


def test_it_has_every_picture_and_verdict_and_nothing_of_pillars(found):
    """Waveforms have both axes of the point and both tractions of the joint, by every solution;
    engines are held against the exact one."""
    text, report = found
    drawn = re.findall(r'<figure id="square-([a-z-]+)-figure"', text)
    assert drawn == ["lead", "scene", "waveforms", "spectra", "energy"]
    assert text.index('id="overview-picture"') < text.index('class="lead"')
    assert "pillar" not in text and not report.page["rock_masses"]
    columns = list(pd.read_csv(report.file.parent / "figures" / "square-waveforms.csv"))
    places = [f"velocity {axis} at [6, 9] m (m/s)" for axis in "xy"]
    places += [f"traction {axis} at [6, 6] m (Pa)" for axis in "ns"]
    for solution in ("dem", "continuum-jointed", "oblique-joint"):
        assert {f"{solution} | {place}" for place in places} <= set(columns)
    scores = report.page["scenes"][0].scores
    for name in ("dem", "continuum-jointed"):
        assert {one.against for one in scores[name].variants} == {"oblique-joint"}
        assert f"{scores[name].verdict.word}</span>" in text
    assert scores["continuum-jointed"].verdict.word == "agrees"
