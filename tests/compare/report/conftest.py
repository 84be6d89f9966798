"""Pages for the tests of the report, each made once."""

import re

import pytest

from compare.report.report import build
from compare.report.section import PAPER

TITLE = "A title of so many words that it takes more than one line on a narrow screen"


@pytest.fixture(scope="session")
def title():
    """Return the title of the scenes of one's own."""
    return TITLE


@pytest.fixture(scope="session")
def own_scene():
    """Return a function of changed lines and names of variants: the free pillar for 30 ms."""

    def text(variants=(), **lines):
        free = (PAPER / "fig-03.toml").read_text(encoding="utf-8").partition("[[variants]]")[0]
        for key, value in {"duration": 0.03, "title": f'"{TITLE}"', **lines}.items():
            free = re.sub(rf"(?m)^{key} *=.*", f"{key} = {value}", free)
        for i, name in enumerate(variants):
            ratio = f"joints.damping_ratio = {0.05 * (i + 1)}"
            free += f'\n[[variants]]\nname = "{name}"\n{ratio}\n'
        return free

    return text


@pytest.fixture(scope="session")
def small_report(once, own_scene):
    """Return the report of two quick scenes: one with variants, and the same recorded by its
    velocities."""

    def made(folder):
        own, moving = folder / "short pillar.toml", folder / "moving.toml"
        own.write_text(text := own_scene(["zeta 0.05"]))
        moving.write_text(re.sub(r"stress *= .*", "velocity = [20.25]", text))
        return build(folder / "report", workers=1, scenes=[str(own), str(moving)])

    return lambda: once("small-report", made)
