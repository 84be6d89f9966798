"""A run that is killed at any moment goes on to the very bits of one that is not."""

import contextlib
import os
import random
import signal
import subprocess
import time

import pytest

from tests.compare.runs.checkpoint.commands import arguments, refuse_difference, until

OLD = b"CDF of an earlier run"
NOTICES = 30  # s, in which mpiexec has long seen that a process has died


def checkpoints(folder):
    return {path.name for path in folder.glob(".*.checkpoint-*-[01].npz")}


def kill(process, ranks, rng):
    """Kill the only process of a run, or one of those that share it, which ends them all. mpiexec
    may wait for ever for one that dies while it is being started: then all are killed."""
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
    [("axial", 2), ("shared", 1), pytest.param("axial", 10, marks=pytest.mark.slow)],
)
def test_killed_run_goes_on_to_the_same_bits(kind, kills, tmp_path, start, finish, whole):
    """Kills at random moments: one in four as it starts, the others soon after a new checkpoint, so
    that every run gets on. Where a checkpoint is due at every look, the run is writing one most of
    the time. What stood there before stays until the new result is whole; a run that ends before it
    is killed is followed by another one."""
    rng, ranks, undisturbed = random.Random(kind), 1 + (kind == "shared"), whole(kind)
    again = arguments(kind, tmp_path, "--resume", "--checkpoint-every", "0.001")
    result = tmp_path / undisturbed.name
    for _ in range(kills):
        result.write_bytes(OLD)
        before, run = checkpoints(tmp_path), start(*again, ranks=ranks)
        if rng.random() < 0.75:
            until(run, lambda before=before: checkpoints(tmp_path) - before)
        time.sleep(rng.uniform(0, 0.2))
        kill(run, ranks, rng)
        if result.read_bytes() != OLD:
            refuse_difference(result, undisturbed)
    code, said = finish(start(*again, ranks=ranks))
    assert code == 0, said
    refuse_difference(result, undisturbed)
    assert {p.name for p in tmp_path.iterdir()} == {p.name for p in undisturbed.parent.iterdir()}
