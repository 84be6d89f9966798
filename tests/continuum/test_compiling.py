"""Compiling forms: said in a line, refused in a line, done again after a run that was killed."""

import logging
import os
import subprocess
import sys

import pytest

from jointwave.continuum.space.compiling import compiled

RUN = """
import logging
from jointwave import cases
from jointwave.compare.scenes import SHIPPED
from jointwave.continuum.scene import body_of
logging.basicConfig(level=logging.INFO, format="%(message)s")
scene = cases.load(SHIPPED / "rock-mass" / "one-joint.toml", {"numerics.continuum.order": 1})[0]
try:
    print(body_of(scene).blocks.count)
except cases.SceneError as error:
    print(error)
"""
SAID = "dolfinx compiles the elements and forms of the rock; later runs load them"


def run(folder, **variables):
    """Return what a run prints and logs with a cache of its own."""
    place = os.environ | {"XDG_CACHE_HOME": str(folder)} | variables
    found = subprocess.run([sys.executable, "-c", RUN], env=place, capture_output=True, text=True)
    return found.stdout.strip(), found.stderr.strip()


def test_a_compiler_that_fails_is_told_in_one_line(tmp_path):
    told, logged = run(tmp_path, CC="false")
    assert "dolfinx needs a C compiler" in told
    assert "\n" not in told
    assert logged in ("", SAID)


def test_forms_are_compiled_where_no_home_can_be_written():
    """XDG_CACHE_HOME is empty, which is as good as unset, and nothing under /proc can be made."""
    told, logged = run("", HOME="/proc/nobody")
    assert told == "2" and logged in ("", SAID)


@pytest.mark.slow
def test_a_killed_run_leaves_nothing_that_stops_the_next(tmp_path):
    """dolfinx waits ten seconds for the other's end."""
    assert run(tmp_path) == ("2", SAID)
    assert run(tmp_path)[0] == "2"
    ready = next(tmp_path.glob("fenics/libffcx_forms_*.c.cached"))
    ready.unlink()
    os.utime(ready.with_suffix(""), (0, 0))
    assert run(tmp_path)[0] == "2"
    assert ready.exists()


def test_the_compilers_leave_logging_as_it_was():
    """Their handlers and their level are taken away again, and what they report is hidden."""
    root, disabled, hidden = logging.getLogger(), logging.root.manager.disable, []
    before = list(root.handlers), root.level

    def make():
        hidden.append(not root.isEnabledFor(logging.INFO) and root.isEnabledFor(logging.WARNING))
        root.addHandler(logging.NullHandler())
        root.setLevel(before[1] + 1)
        raise RuntimeError

    logging.disable(5)
    try:
        with pytest.raises(RuntimeError):
            compiled(make)
        assert hidden == [True] and (list(root.handlers), root.level) == before
        assert logging.root.manager.disable == 5
    finally:
        logging.disable(disabled)
