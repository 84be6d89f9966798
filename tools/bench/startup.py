"""What a run of the rigid blocks costs beyond starting Python with numba, as a ratio.



The two commands are run in turn, so that a machine whose speed drifts slows both; the median of
the pairs' ratios is the figure to quote.
"""

import subprocess
import sys
import tempfile
from statistics import median
from time import perf_counter

SCENE = "guo-li-2002/fig-04"


def seconds(*command: str) -> float:
    """Return the wall time of a command, s."""
    began = perf_counter()
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return perf_counter() - began


def main(pairs: int = 11) -> None:
    """Print the ratio of a warm `jointwave run` to importing numpy and numba."""
    with tempfile.TemporaryDirectory() as out:
        run = (sys.executable, "-m", "compare", "run", SCENE, "--out", out)
        bare = (sys.executable, "-c", "import numpy, numba")
        seconds(*run)  # compiles, where the cache is cold
        ratios = [seconds(*run) / seconds(*bare) for _ in range(pairs)]
    print(
        f"jointwave run {SCENE}, warm, over python -c 'import numpy, numba': "
        f"{median(ratios):.2f} (median of {pairs} pairs, {min(ratios):.2f} to {max(ratios):.2f})"
    )


if __name__ == "__main__":
    main()
