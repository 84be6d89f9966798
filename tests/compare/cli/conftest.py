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


@pytest.fixture(scope="session")
def column():
    """Return a scene in space: a column of two blocks, 2 m high, that a P wave of 8 to 20 m goes
    through."""
    return """
title = "a column"
domain = { size = [1.0, 1.0, 2.0] }
rock = { density = 2600.0, intact_modulus = 5e10, intact_poisson = 0.2 }
waves = [{ kind = "P", direction = [0, 0, 1], shape = "ricker", amplitude = 1e6, period = 6e-3 }]
time = { duration = 1.2e-2 }
numerics = { continuum.size = 1.0 }
record = { points = [[0.3, 0.3, 0.5], [0.3, 0.3, 1.5]], joints = [[0.5, 0.5, 1.0]] }
expect = { "continuum-jointed ~ oblique-joint" = 0.01 }
boundaries.bottom = "quiet"
boundaries.top = "quiet"
boundaries.left = "roller"
boundaries.right = "roller"
boundaries.front = "roller"
boundaries.back = "roller"

[[joint_sets]]
name = "bed"
dip = 0.0
spacing = 1.0
through = [0.0, 0.0, 1.0]
normal_stiffness = 2e10
shear_stiffness = 8e9
"""
