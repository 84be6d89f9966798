"""The installation on this machine, and whether both engines compute correctly here.

Libraries are checked in separate processes: a broken one is a line of the report.
"""

import json
import os
import platform
import subprocess
import sys
from collections.abc import Callable
from importlib.metadata import version
from math import isnan, nan
from pathlib import Path
from shutil import which
from typing import NamedTuple

from compare.cli.diagnostics.accuracy import PAIRS, Check, bound_of
from compare.cli.diagnostics.components import PROBES
from compare.cli.terminal import print_json, say, show_table

PATIENCE = 120.0  # s, for what only looks
COMPILING = 1200.0  # s, for the self-check, which compiles where the cache is empty
MOST_RANKS = 16  # that are tried
COUNT_RANKS = """
from mpi4py import MPI
ranks = MPI.COMM_WORLD.allreduce(1)
if MPI.COMM_WORLD.rank == 0:  # one speaks: lines of several ranks may run into each other
    print(ranks)
"""

#: What a self-check needs that an installation may be without.
NEEDS = {PAIRS[1]: "basix"}

COLOURS = {"missing": "yellow", "broken": "bold red"}


class Component(NamedTuple):
    """A line of the report: "found", "missing" or "broken", and what to do about it."""

    group: str
    part: str
    state: str
    found: str
    hint: str = ""


class Health(NamedTuple):
    """The report of `jointwave doctor`."""

    parts: list[Component]
    checks: list[Check]

    @property
    def is_well(self) -> bool:
        """Whether the engines that are installed give what they should."""
        return all(check.holds for check in self.checks)


def examine(progress: Callable[[float], None]) -> Health:
    """Look at everything; `progress` is called with the finished fraction."""
    program = f"{version('jointwave')}, Python {platform.python_version()} ({sys.executable})"
    parts = [Component("program", "jointwave", "found", program), *_libraries()]
    progress(0.3)
    parts += [_mpiexec(), *_machine(), _cache()]
    progress(0.5)
    missing = {part.part for part in parts if part.state == "missing"}
    pairs, checks = [pair for pair in PAIRS if NEEDS.get(pair) not in missing], []
    for i, pair in enumerate(pairs):
        checks.append(_check(pair))
        progress(0.5 + 0.5 * (i + 1) / len(pairs))
    groups = [one.group for one in PROBES.values()]
    return Health(sorted(parts, key=lambda part: groups.index(part.group)), checks)


def _libraries() -> list[Component]:
    """Return what the probes find; one that ends its process is broken, and the next go on."""
    left, parts = list(PROBES), []
    while left:
        done = _run([sys.executable, "-m", f"{__package__}.components", *left], PATIENCE)
        found = [json.loads(line) for line in done.stdout.splitlines() if line.startswith("{")]
        if len(found) < len(left):
            found.append({"part": left[len(found)], "state": "broken", "found": _end(done)})
        for one in found:
            probe = PROBES[one["part"]]
            hint = probe.hint if one["state"] != "found" else ""
            parts.append(Component(probe.group, **one, hint=hint))
        left = left[len(found) :]
    return parts


def _mpiexec() -> Component:
    """Return how many processes the launcher starts that see each other."""
    own = str(Path(sys.executable).parent)  # of this Python's own environment, if it has one
    launcher, cores = which("mpiexec", path=own) or which("mpiexec"), min(_cores(), MOST_RANKS)
    if launcher is None:
        hint = "apt install openmpi-bin; or conda install -c conda-forge mpich"
        return Component("continuum", "mpiexec", "missing", "is not on the PATH", hint)
    for ranks in sorted({cores, min(2, cores), 1}, reverse=True):
        done = _run([launcher, "-n", str(ranks), sys.executable, "-c", COUNT_RANKS], PATIENCE)
        if done.stdout.strip() == str(ranks):
            most = " or more" if ranks == MOST_RANKS else ""
            found = f"{launcher}: {ranks}{most} ranks on {_cores()} cores"
            return Component("continuum", "mpiexec", "found", found)
    if os.geteuid() == 0 and "run-as-root" in done.stderr.lower().replace(" ", "-"):
        hint = "set OMPI_ALLOW_RUN_AS_ROOT=1 and OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1"
        return Component(
            "continuum", "mpiexec", "broken", f"{launcher} refuses to run as root", hint
        )
    found = f"{launcher} starts no ranks: {_end(done)}"
    return Component("continuum", "mpiexec", "broken", found, "mpi4py may belong to another MPI")


def _machine() -> list[Component]:
    from cases.errors import SceneError
    from cases.size import LIMIT, memory, spoken

    try:
        size = Component("machine", "memory", "found", f"{spoken(memory())} available to a run")
    except SceneError as error:
        size = Component("machine", "memory", "broken", str(error), f"unset {LIMIT}")
    cores = f"{_cores()} of {os.cpu_count()}, {platform.machine()}, {platform.platform()}"
    return [Component("machine", "cores", "found", cores), size]


def _cores() -> int:
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _cache() -> Component:
    """Return where compiled kernels are kept, and how large that has grown."""
    from cases.size import spoken

    try:
        from numerics import jit
    except Exception as error:
        return Component("machine", "kernel cache", "broken", f"numba cannot be imported: {error}")
    folder = jit.DIRECTORY.parent
    files = [file for file in folder.rglob("*") if file.is_file()] if folder.is_dir() else []
    size = spoken(sum(file.stat().st_size for file in files))
    states = sum(place.is_dir() for place in folder.iterdir()) if folder.is_dir() else 0
    found = f"{folder}: {size} for {states} versions of the code; `rm -r {folder}` clears it"
    place = next(place for place in (folder, *folder.parents) if place.exists())
    if not os.access(place, os.W_OK):
        hint = "set NUMBA_CACHE_DIR to a writable folder, or every run compiles"
        return Component("machine", "kernel cache", "broken", f"{folder} cannot be written", hint)
    return Component("machine", "kernel cache", "found", found)


def _check(pair: str) -> Check:
    done = _run([sys.executable, "-m", f"{__package__}.accuracy", pair], COMPILING)
    try:
        return Check(**json.loads(done.stdout.splitlines()[-1]))
    except (ValueError, IndexError, TypeError):
        return Check(pair, nan, bound_of(pair), nan, _end(done))


def _run(command: list[str], seconds: float) -> subprocess.CompletedProcess[str]:
    """Return a process that has ended, by itself or because its time was up.

    What a library has put into this process's own environment, as MPI does, is not passed on.
    """
    try:
        return subprocess.run(
            command,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            timeout=seconds,
            env=dict(os.environ),
        )
    except subprocess.TimeoutExpired as error:
        said = error.stdout or b""
        text = said.decode(errors="replace") if isinstance(said, bytes) else said
        return subprocess.CompletedProcess(command, 1, text, f"took more than {seconds:g} s")


def _end(done: subprocess.CompletedProcess[str]) -> str:
    """Return in one line how a process has ended that did not do its work."""
    lines = [line.strip() for line in done.stderr.splitlines() if any(map(str.isalnum, line))]
    how = f"signal {-done.returncode}" if done.returncode < 0 else f"exit code {done.returncode}"
    return f"{lines[-1][:300]} ({how})" if lines else f"ended with {how}"


def show_health(found: Health, as_json: bool) -> None:
    """Print every part, and what the engines' checks came to."""
    if as_json:
        checks = [{**check._asdict(), "holds": check.holds} for check in found.checks]
        parts = [part._asdict() for part in found.parts]
        print_json({"parts": parts, "self_check": checks, "well": found.is_well})
        return
    rows = [[p.group, p.part, p.state, _said(p.found, p.hint)] for p in found.parts]
    show_table(["", "part", "state", ""], rows, [COLOURS.get(p.state, "") for p in found.parts])
    say("")
    for check in found.checks:
        say(_sentence(check), "green" if check.holds else "bold red")
    say("all checks pass" if found.is_well else "a check fails: see the self-check above")


def _said(found: str, hint: str) -> str:
    return f"{found}; {hint}" if hint else found


def _sentence(check: Check) -> str:
    verdict = "holds" if check.holds else "FAILS"
    if isnan(check.misfit):
        return f"self-check {check.pair}: {verdict}, {check.reason}"
    return (
        f"self-check {check.pair}: {verdict}, relative L2 misfit {check.misfit:.3g}, "
        f"at most {check.bound:g}, in {check.seconds:.1f} s"
    )
