"""What `make setup` and the wheel install: a set that fits, one name, all that a run needs."""

import os
import shutil
import subprocess
import sys
import tomllib
import zipfile
from itertools import chain
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).parents[1]
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
    command = ["bash", "-c", TELLING, "bash", ROOT / "tools" / "setup.sh"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=600)
    assert done.stdout == "done\nexit code 3\n" and done.returncode == 0
    lines = done.stderr.splitlines()
    assert lines and all(line.startswith("setup: pip install, for ") for line in lines)


@pytest.mark.parametrize(("python", "numpy"), [("3.11", "1"), ("3.13", "2")])
def test_the_lock_has_each_dependency_once_at_a_version_that_is_admitted(python, numpy):
    """Of every extra, on the system whose wheels FEniCSx has; numpy 1 where Debian 12 needs it."""
    system = {"sys_platform": "linux", "platform_machine": "x86_64", "extra": ""}
    system |= {"python_version": python, "python_full_version": f"{python}.9"}
    system["implementation_name"] = "cpython"

    def held(lines):
        found = [Requirement(line) for line in lines if not line.startswith("#")]
        return [one for one in found if one.marker is None or one.marker.evaluate(system)]

    pins: dict[str, str] = {}
    for pin in held((ROOT / "constraints.txt").read_text(encoding="utf-8").splitlines()):
        assert pin.name not in pins
        (pins[pin.name],) = (one.version for one in pin.specifier)
    assert pins["numpy"].partition(".")[0] == numpy
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    for one in held(chain(project["dependencies"], *project["optional-dependencies"].values())):
        name = canonicalize_name(one.name)
        assert name == project["name"] or pins[name] in one.specifier, one


def built(folder):
    """Return the wheel of this source, built in a folder of its own."""
    (source := folder / "source").mkdir()
    for path in ROOT.iterdir():
        if (path / "__init__.py").is_file():
            caches = shutil.ignore_patterns("__pycache__")
            shutil.copytree(path, source / path.name, False, caches, shutil.copyfile)
        elif path.is_file() and path.name[0] != ".":
            shutil.copyfile(path, source / path.name)
    build = "from setuptools import build_meta as b; print(b.build_wheel('..'))"
    written = {**os.environ, "SOURCE_DATE_EPOCH": "1700000000"}  # s since 1970, of every file
    command, said = [sys.executable, "-c", build], {"capture_output": True, "text": True}
    done = subprocess.run(command, cwd=source, check=True, env=written, **said)
    return folder / done.stdout.split()[-1]


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    """Return the wheel of this source."""
    return built(tmp_path_factory.mktemp("wheel"))


@pytest.fixture(scope="module")
def site(wheel):
    """Return a folder that the wheel is unpacked in, as pip would."""
    zipfile.ZipFile(wheel).extractall(wheel.parent / "site")
    return wheel.parent / "site"


def run(site, *arguments, **environment):
    """Return the output of a Python that sees the wheel and not the repository."""
    place = {**os.environ, "PYTHONPATH": str(site), **environment}
    command, said = [sys.executable, "-P", *arguments], {"capture_output": True, "text": True}
    done = subprocess.run(command, cwd=site.parent, env=place, **said)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_wheel_is_the_same_in_every_bit(wheel, tmp_path):
    """Built anew, from files of another time in another folder."""
    assert built(tmp_path).read_bytes() == wheel.read_bytes()


def test_no_module_asks_for_a_name_of_the_repository(site):
    """One name is at the top. All are imported, but those that need what this machine may lack."""
    assert {path.name.partition("-")[0] for path in site.iterdir()} == {"jointwave"}
    code = """
import sys
from importlib import import_module
from pathlib import Path
import jointwave
root = Path(jointwave.__file__).parents[1]
optional = {"basix", "dolfinx", "gmsh", "mpi4py", "petsc4py", "pyvista", "vtk", "vtkmodules"}
for source in sorted(root.rglob("*.py")):
    name = ".".join(source.relative_to(root).with_suffix("").parts).removesuffix(".__init__")
    if not name.endswith("__main__"):
        try:
            import_module(name)
        except ImportError as error:
            assert (error.name or "").partition(".")[0] in optional, (name, error)
ours = {"cases", "results", "numerics", "joints", "dem", "continuum", "compare"}
print(sorted(ours & set(sys.modules)), len(sys.modules))
"""
    assert run(site, "-c", code).startswith("[] ")


@pytest.mark.slow  # it compiles every kernel that the scene needs
def test_the_command_compares_a_shipped_scene(site):
    found = run(site, "-m", "jointwave", "compare", "guo-li-2002/fig-03", "--json")
    assert '"dem"' in found


def test_scenes_are_tests(site):
    (site.parent / "scenes").mkdir()
    shipped = site / "jointwave" / "cases" / "guo-li-2002" / "fig-03.toml"
    text = shipped.read_text().partition("[expect]")[0] + '[expect]\n"series ~ images" = 1e-3\n'
    (site.parent / "scenes" / "bar.toml").write_text(text)
    plugin = ("-p", "jointwave.pytest_plugin", "-p", "no:cacheprovider", "--rootdir", "scenes")
    found = run(site, "-m", "pytest", *plugin, "scenes", PYTEST_DISABLE_PLUGIN_AUTOLOAD="1")
    assert "1 passed" in found
