"""What is installed: one name in site-packages, and a program that runs without the repository."""

import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]


#: When the sources are said to have been written, s since 1970: of every file of a wheel.
WRITTEN = "1700000000"


def built(folder):
    """Return the wheel of this source, built in a folder of its own."""
    source = folder / "source"
    source.mkdir()
    for path in ROOT.iterdir():
        if (path / "__init__.py").is_file():
            caches = shutil.ignore_patterns("__pycache__")
            shutil.copytree(path, source / path.name, False, caches, shutil.copyfile)
        elif path.is_file() and path.name[0] != ".":
            shutil.copyfile(path, source / path.name)
    build = "from setuptools import build_meta as b; print(b.build_wheel('..'))"
    done = subprocess.run(
        [sys.executable, "-c", build], cwd=source, capture_output=True, text=True, check=True,
        env={**os.environ, "SOURCE_DATE_EPOCH": WRITTEN},
    )  # fmt: skip
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


def run(site, *arguments, code=0, **environment):
    """Return the output of a Python that sees the wheel and not the repository."""
    done = subprocess.run(
        [sys.executable, "-P", *arguments],
        cwd=site.parent,
        capture_output=True,
        text=True,
        env={**os.environ, "PYTHONPATH": str(site), **environment},
    )
    assert done.returncode == code, done.stderr
    return done.stdout + done.stderr


def test_wheel_is_the_same_in_every_bit(wheel, tmp_path):
    """Built anew, from files of another time in another folder."""
    assert built(tmp_path).read_bytes() == wheel.read_bytes()


def test_one_name_at_the_top(site):
    names = {path.name for path in site.iterdir()}
    assert {name.partition("-")[0] for name in names} == {"jointwave"}


def test_no_module_asks_for_a_name_of_the_repository(site):
    """All are imported, but those that need what this machine may lack."""
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
