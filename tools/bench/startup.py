"""Start-up cost: a warm run over importing numpy and numba, and a first run over a second.

    python tools/bench/startup.py

Two commands run in turn, so that drift of the machine's speed affects both; quote the median of the
ratios. The first run compiles kernels: its processor time over the second's is the cost.
"""

import os
import subprocess
import sys
import tempfile
from resource import RUSAGE_CHILDREN, getrusage
from statistics import median
from time import perf_counter

SCENE = "guo-li-2002/fig-03"
BARE = (sys.executable, "-c", "import numpy, numba")
#: Runs of the first-over-second ratio: the chain, the continuum, the row of blocks in space.
FIRST = {
    "free pillar, dem": ("guo-li-2002/fig-03", "--engine", "dem"),
    "free pillar, continuum": ("guo-li-2002/fig-03", "--engine", "continuum"),
    "block on an incline, dem": ("beyond/block-on-incline", "--engine", "dem"),
}


def seconds(*command: str, **environment: str) -> tuple[float, float]:
    """Return the wall time and the processor time of a command, s."""
    began, before = perf_counter(), getrusage(RUSAGE_CHILDREN)
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, env=os.environ | environment)
    after = getrusage(RUSAGE_CHILDREN)
    spent = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return perf_counter() - began, spent


def run_of(*scene: str, out: str) -> tuple[str, ...]:
    """Return the command that runs a scene."""
    return sys.executable, "-m", "jointwave", "run", *scene, "--variant", "", "--out", out


def first_over_second(*scene: str) -> tuple[float, float]:
    """Return the processor times of a run with an empty cache and of the next run, s."""
    with tempfile.TemporaryDirectory() as place:
        command = run_of(*scene, out=os.path.join(place, "out"))
        caches = {"XDG_CACHE_HOME": place, "NUMBA_CACHE_DIR": os.path.join(place, "numba")}
        first, second = (seconds(*command, **caches)[1] for _ in range(2))
    return first, second


def main(pairs: int = 11) -> None:
    """Print both ratios."""
    with tempfile.TemporaryDirectory() as out:
        run = run_of(SCENE, out=out)
        seconds(*run)  # compiles if the cache is cold
        ratios = [seconds(*run)[0] / seconds(*BARE)[0] for _ in range(pairs)]
    print(
        f"jointwave run {SCENE}, warm, over python -c 'import numpy, numba': "
        f"{median(ratios):.2f} (median of {pairs} pairs, {min(ratios):.2f} to {max(ratios):.2f})"
    )
    for name, scene in FIRST.items():
        first, second = first_over_second(*scene)
        print(
            f"{name}: first run {first:.1f} s of processor time, second {second:.1f} s, "
            f"ratio {first / second:.1f}"
        )


if __name__ == "__main__":
    main()
