"""tools/setup.sh says what it does while a part of it takes long."""

import subprocess
from pathlib import Path

SETUP = Path(__file__).parents[1] / "tools" / "setup.sh"
TELLING = r"""
set -euo pipefail
eval "$(sed -n '/^say()/p; /^telling()/,/^}/p' "$1")"
every=0.4
telling 'pip install' bash -c 'sleep 1; echo done; exit 3' || echo "exit code $?"
every=100
telling 'pip install' true
"""


def test_what_takes_long_says_so_on_standard_error_and_keeps_its_exit_code():
    """Nothing that it started holds a pipe open, or this would wait for 100 s."""
    done = subprocess.run(
        ["bash", "-c", TELLING, "bash", SETUP], capture_output=True, text=True, timeout=60
    )
    assert done.stdout == "done\nexit code 3\n" and done.returncode == 0
    lines = done.stderr.splitlines()
    assert lines and all(line.startswith("setup: pip install, for ") for line in lines)
