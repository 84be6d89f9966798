"""A run that is killed at any moment goes on to the very bits of one that is not."""

import contextlib
import os
import random
import signal
import subprocess
import time

import pytest

OLD = b"CDF of an earlier run"
NOTICES = 30  # s, in which mpiexec has long seen that a process has died
QUICK = {"axial": 2, "shared": 1}  # what other engines show their keepers: test_resume.py
ALL = dict.fromkeys(("axial", "spatial", "explicit", "implicit", "shared"), 10)


def kinds():
    """Yield each kind of run with the number of kills that it has to survive."""
    for kind, kills in QUICK.items():
        yield pytest.param(kind, kills, id=f"{kind}-{kills}")
    for kind, kills in ALL.items():
        yield pytest.param(kind, kills, id=f"{kind}-{kills}", marks=pytest.mark.slow)


def checkpoints(folder):
    """Return the names of the checkpoints in a folder."""
    return {path.name for path in folder.glob(".*.checkpoint-*-[01].npz")}


def kill(process, ranks, rng):
    """Kill the only process of a run, or one of those that share it, which ends them all.

    mpiexec may wait for ever for one that dies while it is being started: then all are killed.
    """
    victim = process.pid
    if ranks > 1:
        children = subprocess.run(
            ["pgrep", "-P", str(victim), "-f", "compare"], capture_output=True, text=True
        )
        victim = int(rng.choice(children.stdout.split() or [victim]))
    with contextlib.suppress(ProcessLookupError):
        os.kill(victim, signal.SIGKILL)
    try:
        process.communicate(timeout=NOTICES)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        process.communicate()


@pytest.fixture
def struck(until):
    """Return a function that kills a run at a random moment; returns whether it came in time.

    One in four kills comes within the first seconds, the others soon after a new checkpoint: so
    every run gets on, however slow the machine is.
    """

    def strike(run, out, ranks, rng):
        before, early = checkpoints(out), rng.random() < 0.25
        delay = rng.uniform(0, 2.0 if early else 0.2)
        if not early and not until(run, lambda: checkpoints(out) - before):
            return False
        time.sleep(delay)
        if run.poll() is not None:
            return False
        kill(run, ranks, rng)
        return True

    return strike


@pytest.mark.parametrize(("kind", "kills"), list(kinds()))
def test_killed_run_goes_on_to_the_same_bits(
    kind, kills, tmp_path, start, finish, struck, arguments, runs, whole, refuse_difference
):
    """Kills at random moments, of starting up, of stepping, and of writing checkpoints.

    Where a checkpoint is due at every look, the run is writing one most of the time. What stood
    there before stays until the new result is whole. Runs that end before they have been killed
    often enough are followed by others.
    """
    rng, done = random.Random(f"{kind} {kills}"), 0
    (file, ranks), undisturbed = runs[kind], whole(kind)
    for attempt in range(10 * kills):
        if done == kills:
            break
        out = tmp_path / f"killed {attempt}"
        out.mkdir()
        (out / file).write_bytes(OLD)
        ended = False
        while not ended:
            every = rng.choice(["0.001", "0.05"])
            again = arguments(kind, out, "--resume", "--checkpoint-every", every)
            run = start(*again, ranks=ranks)
            ended = done == kills or not struck(run, out, ranks, rng)
            done += not ended
            if (out / file).read_bytes() != OLD:
                refuse_difference(out / file, undisturbed / file)
        code, said = finish(run)
        assert code == 0, said
        refuse_difference(out / file, undisturbed / file)
        assert {p.name for p in out.iterdir()} == {p.name for p in undisturbed.iterdir()}
    assert done == kills
