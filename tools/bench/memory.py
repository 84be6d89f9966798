"""The memory of a block, from whole runs."""

import resource
import subprocess
import sys
from pathlib import Path

from rows import changed

MOST = 1_000_000

#: A row in space whose joints slide, with dashpots and ledger.
SLIDES = {
    "load.direction": [0.6, 0.8, 0.0],
    "load.at": [0.1, 0.05],
    "joints.friction_angle": 30.0,
    "joints.cohesion": 1e12,
    "joints.damping_ratio": 0.02,
    "time.duration": 5e-5,
}


def peak() -> float:
    """Return the largest memory this process has had, bytes."""
    status = Path("/proc/self/status")
    if status.exists():  # the other figure begins with that of the process it was started from
        line = next(x for x in status.read_text().splitlines() if x.startswith("VmHWM"))
        return 1024.0 * float(line.split()[1])
    return 1024.0 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


def one_run(blocks: int) -> None:
    """Run a row of so many blocks and print this process's peak."""
    from jointwave.dem import simulate

    simulate(changed(SLIDES, blocks))
    print(peak())


def main() -> None:
    """Print bytes per block of whole runs."""
    few, many = (float(_apart(blocks)) for blocks in (1000, MOST))
    print(
        f"memory: {(many - few) / MOST:.0f} bytes a block, peak of a whole run of {MOST:,} blocks"
    )


def _apart(blocks: int) -> str:
    command = (sys.executable, __file__, str(blocks))
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


if __name__ == "__main__":
    one_run(int(sys.argv[1])) if len(sys.argv) > 1 else main()
