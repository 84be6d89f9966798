"""tools/setup.sh says what it does while a part of it takes long, and installs a set that fits."""

import subprocess
import tomllib
from itertools import chain
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).parents[1]
SETUP = ROOT / "tools" / "setup.sh"
TELLING = r"""
set -euo pipefail
eval "$(sed -n '/^say()/p; /^telling()/,/^}/p' "$1")"
every=0.4
telling 'pip install' bash -c 'sleep 1; echo done; exit 3' || echo "exit code $?"
every=100
telling 'pip install' true
"""


def test_what_takes_long_says_so_on_standard_error_and_keeps_its_exit_code():
    """Nothing that it started holds a pipe open, or this would wait for 100 s."""
    done = subprocess.run(
        ["bash", "-c", TELLING, "bash", SETUP], capture_output=True, text=True, timeout=600
    )
    assert done.stdout == "done\nexit code 3\n" and done.returncode == 0
    lines = done.stderr.splitlines()
    assert lines and all(line.startswith("setup: pip install, for ") for line in lines)


@pytest.mark.parametrize(("python", "numpy"), [("3.11", "1"), ("3.13", "2")])
def test_the_lock_has_each_dependency_once_at_a_version_that_is_admitted(python, numpy):
    """Of every extra, on the system whose wheels FEniCSx has; numpy 1 where Debian 12 needs it."""
    system = {
        "sys_platform": "linux",
        "platform_machine": "x86_64",
        "implementation_name": "cpython",
    }
    system |= {"python_version": python, "python_full_version": f"{python}.9", "extra": ""}
    lines = (ROOT / "constraints.txt").read_text(encoding="utf-8").splitlines()
    pins: dict[str, str] = {}
    for pin in held(lines, system):
        assert pin.name not in pins
        (pins[pin.name],) = (one.version for one in pin.specifier)
    assert pins["numpy"].partition(".")[0] == numpy
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    wanted = list(chain(project["dependencies"], *project["optional-dependencies"].values()))
    for one in held(wanted, system):
        name = canonicalize_name(one.name)
        assert name == project["name"] or pins[name] in one.specifier, one


def held(lines, system):
    """Return the requirements among lines that a system has."""
    found = [Requirement(line) for line in lines if not line.startswith("#")]
    return [one for one in found if one.marker is None or one.marker.evaluate(system)]
