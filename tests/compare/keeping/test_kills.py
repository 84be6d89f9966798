"""A run that is killed at any moment goes on to the very bits of one that is not."""

import contextlib
import os
import random
import signal
import subprocess
import time

import pytest

OLD = b"of an earlier run"
QUICK = {"axial": 2, "spatial": 2, "explicit": 1, "implicit": 2, "shared": 1}
ALL = dict.fromkeys(QUICK, 10)


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
    """Kill the only process of a run, or one of those that share it, which ends them all."""
    victim = process.pid
    if ranks > 1:
        children = subprocess.run(
            ["pgrep", "-P", str(victim), "-f", "compare"], capture_output=True, text=True
        )
        victim = int(rng.choice(children.stdout.split() or [victim]))
    with contextlib.suppress(ProcessLookupError):
        os.kill(victim, signal.SIGKILL)
    process.communicate()


@pytest.mark.parametrize(("kind", "kills"), list(kinds()))
def test_killed_run_goes_on_to_the_same_bits(
    kind, kills, tmp_path, start, finish, until, arguments, runs, refuse_difference
):
    """Kills at random moments, of starting up, of stepping, and of writing checkpoints.

    One in four comes within the first seconds, the others soon after a new checkpoint: so every
    run gets on, however slow the machine is. Where a checkpoint is due at every look, the run is
    writing one most of the time. What stood there before stays until the new result is whole.
    """
    rng, done, ended = random.Random(f"{kind} {kills}"), 0, 0
    file, ranks = runs[kind]
    whole = tmp_path / "whole"
    code, said = finish(start(*arguments(kind, whole, "--checkpoint-every", "0"), ranks=ranks))
    assert code == 0, said
    while done < kills:
        out = tmp_path / f"killed {ended}"
        out.mkdir()
        (out / file).write_bytes(OLD)
        while True:
            every, before = rng.choice(["0.001", "0.05"]), checkpoints(out)
            again = arguments(kind, out, "--resume", "--checkpoint-every", every)
            run, early = start(*again, ranks=ranks), rng.random() < 0.25
            delay = rng.uniform(0, 2.0 if early else 0.2)
            if done < kills and (early or until(run, lambda b=before: checkpoints(out) - b)):
                time.sleep(delay)
                if run.poll() is None:
                    kill(run, ranks, rng)
                    done += 1
                    if (out / file).read_bytes() != OLD:
                        refuse_difference(out / file, whole / file)
                    continue
            code, said = finish(run)
            assert code == 0, said
            break
        refuse_difference(out / file, whole / file)
        assert {p.name for p in out.iterdir()} == {p.name for p in whole.iterdir()}
        ended += 1
