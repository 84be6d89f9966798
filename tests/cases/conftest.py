"""Scenes that the tests of this folder start from."""

from pathlib import Path

import pytest

import cases


@pytest.fixture(scope="session")
def paper_folder() -> Path:
    """The scenes of the paper's figures."""
    return Path(cases.__file__).parent / "guo-li-2002"


@pytest.fixture(scope="session")
def scene_with(paper_folder):
    """A function of dotted keys: the undamped, free-ended pillar of figure 3 with them changed."""
    alone = {"variants": []}  # each is validated, and some contradict some changes
    return lambda **changes: cases.load(paper_folder / "fig-03.toml", alone | changes)[0]
