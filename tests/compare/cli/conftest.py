"""Shared by the tests of commands: each works in a folder of its own, without a display."""

import re
from pathlib import Path

import pytest


@pytest.fixture(autouse=True)
def here(monkeypatch, tmp_path):
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.chdir(tmp_path)


@pytest.fixture(scope="session")
def words_of():
    """Return a function that gives the words of an SVG file."""
    return lambda svg: re.findall(r">([^<>]+)</text>", Path(svg).read_text(encoding="utf-8"))
