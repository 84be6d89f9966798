"""Shared by the tests of checkpoints: real processes, which are started, stopped and waited for."""

import os
import signal
import subprocess
import sys

import pytest

from tests.compare.runs.checkpoint.commands import PATIENCE, arguments, until


@pytest.fixture
def start(request):
    """Return a function that starts `jointwave` with these arguments, on so many processes. None is
    left running. Each is the first of a process group of its own, so that Ctrl-C can reach all of
    one, and minds it even where the tests run in the background."""
    begun = []

    def started(*arguments, ranks=1, out=subprocess.PIPE):
        command = [sys.executable, "-m", "jointwave", *map(str, arguments)]
        environment = None
        if ranks > 1:
            mpiexec, environment = request.getfixturevalue("mpiexec")
            command = [*mpiexec, "-n", str(ranks), *command]
        begun.append(
            subprocess.Popen(
                command,
                stdout=out,
                stderr=subprocess.PIPE,
                text=True,
                env=environment,
                start_new_session=True,
                preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
            )
        )
        return begun[-1]

    yield started
    for process in begun:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
            process.communicate()


@pytest.fixture
def finish(without_warnings):
    """Return a function that waits for a process to end; gives its exit code and its own lines,
    but for warnings: the scenes end early."""

    def finished(process):
        _, said = process.communicate(timeout=PATIENCE)
        assert "Traceback" not in said, said
        lines = [line for line in without_warnings(said) if line.startswith("jointwave: ")]
        return process.returncode, lines

    return finished


@pytest.fixture
def said(jointwave, without_warnings):
    return lambda *run, code=0: without_warnings(jointwave(*run, code=code).err)


@pytest.fixture
def stopped(start, finish):
    """Return a function that starts a run, sends it a signal at its first checkpoint in a folder,
    and gives its exit code and its lines."""

    def ended(run, folder, number):
        process = start(*run)
        assert until(process, lambda: list(folder.glob(".*.checkpoint-*-0.npz")))
        process.send_signal(number)
        return finish(process)

    return ended


@pytest.fixture
def whole(once, start, finish):
    """Return a function that gives the result of a run of RUNS that nothing ended, made once."""

    def of(kind):
        def made(folder):
            code, lines = finish(start(*arguments(kind, folder), ranks=1 + (kind == "shared")))
            assert code == 0, lines
            (result,) = folder.glob("*.nc")
            return result

        return once(f"whole-{kind}", made)

    return of
