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


def checkpoints(folder):
    return {path.name for path in folder.glob(".*.checkpoint-*-[01].npz")}


def kill(process, ranks, rng):
    """Kill the only process of a run, or one of those that share it, which ends them all.

    mpiexec may wait for ever for one that dies while it is being started: then all are killed.
    """
    victim = process.pid
    if ranks > 1:
        named = ["pgrep", "-P", str(victim), "-f", "compare"]
        children = subprocess.run(named, capture_output=True, text=True).stdout.split()
        victim = int(rng.choice(children or [victim]))
    with contextlib.suppress(ProcessLookupError):
        os.kill(victim, signal.SIGKILL)
    try:
        process.communicate(timeout=NOTICES)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        process.communicate()


@pytest.mark.parametrize(
    ("kind", "kills"),
    [
        *(("axial", 2), ("shared", 1)),
        *(pytest.param(kind, 10, marks=pytest.mark.slow) for kind in ("axial", "shared")),
    ],
)
def test_killed_run_goes_on_to_the_same_bits(
    kind, kills, tmp_path, start, finish, until, arguments, whole, refuse_difference
):
    """Kills at random moments: one in four within the first seconds, the others soon after a new
    checkpoint, so that every run gets on, however slow the machine is. Where a checkpoint is due at
    every look, the run is writing one most of the time. What stood there before stays until the new
    result is whole. Runs that end before they have been killed often enough are followed by others.
    """
    rng, done = random.Random(f"{kind} {kills}"), 0
    ranks, undisturbed = 1 + (kind == "shared"), whole(kind)

    def is_struck(run, out):
        before, early = checkpoints(out), rng.random() < 0.25
        delay = rng.uniform(0, 2.0 if early else 0.2)
        if not early and not until(run, lambda: checkpoints(out) - before):
            return False
        time.sleep(delay)
        if run.poll() is not None:
            return False
        kill(run, ranks, rng)
        return True

    for attempt in range(10 * kills):
        if done == kills:
            break
        out = tmp_path / f"killed {attempt}"
        out.mkdir()
        result = out / undisturbed.name
        result.write_bytes(OLD)
        ended = False
        while not ended:
            every = rng.choice(["0.001", "0.05"])
            again = arguments(kind, out, "--resume", "--checkpoint-every", every)
            run = start(*again, ranks=ranks)
            ended = done == kills or not is_struck(run, out)
            done += not ended
            if result.read_bytes() != OLD:
                refuse_difference(result, undisturbed)
        code, said = finish(run)
        assert code == 0, said
        refuse_difference(result, undisturbed)
        assert list(out.iterdir()) == [result]
    assert done == kills
