"""`make fuzz`: inputs made by a coverage-guided fuzzer, atheris, meet what reads them.

    usage: python tools/fuzz [--inputs 10000] [--only TARGET] [--seed 1] [--keep FOLDER]

Each target of `targets` gets a share of the inputs, in a process of its own that starts from the
shipped files. An input may take 5 s and the process 2 GB; the first that takes more, or ends in
anything but one line, is kept as a file and ends that target. The last line counts; exit 1 where
anything was found.
"""

import argparse
import re
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[2]
PLACE = ROOT / ".fuzz"  # where atheris is: beside the project's own environment
VERSION = "atheris==3.0.*"
SECONDS, MEGABYTES = 5, 2048  # what one input, of the processor, and a process may take
HANGS = 60  # s that an input may take on a busy machine
LONGEST = 20_000  # bytes of an input
#: What part of the inputs each target gets.
SHARES = {"scene": 0.4, "load": 0.1, "curve": 0.1, "study": 0.15, "mesh": 0.1, "command": 0.15}


class Found(NamedTuple):
    """What became of a target: inputs met, and what was found in words, empty without."""

    inputs: int
    fault: str


def main() -> int:
    """Run all targets, and say what was found."""
    parser = argparse.ArgumentParser(prog="tools/fuzz")
    parser.add_argument("--inputs", type=int, default=10_000)
    parser.add_argument("--only", choices=SHARES)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--keep", type=Path, default=ROOT / "build" / "fuzz")
    asked = parser.parse_args()
    if reason := install():
        print(f"fuzz: {reason}")
        return 1
    names = [asked.only] if asked.only else list(SHARES)
    whole = sum(SHARES[name] for name in names)
    share = {n: round(asked.inputs * SHARES[n] / whole) for n in names}
    found = {n: fuzz(n, share[n], asked.keep, asked.seed) for n in names}
    faults = sum(bool(one.fault) for one in found.values())
    inputs = sum(one.inputs for one in found.values())
    print(f"{inputs} inputs, {faults} faults; at most {SECONDS} s and {MEGABYTES} MB each")
    return 1 if faults else 0


def install() -> str:
    """Install atheris where it is not; return "" or why it cannot be had."""
    if (PLACE / "atheris").is_dir():
        return ""
    command = [sys.executable, "-m", "pip", "--disable-pip-version-check", "install", "-q"]
    options = ["--no-deps", "--only-binary", ":all:", "--target", str(PLACE), VERSION]
    done = subprocess.run([*command, *options], capture_output=True, text=True)
    return "" if done.returncode == 0 else f"no atheris: {done.stderr.strip().splitlines()[-1]}"


def fuzz(name: str, inputs: int, keep: Path, seed: int = 1) -> Found:
    """Let a target meet so many inputs in a process of its own, and say what came of it."""
    keep.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        driver, corpus = Path(__file__).with_name("driver.py"), Path(folder, "corpus")
        options = [
            f"-runs={inputs}",
            f"-timeout={HANGS}",
            f"-rss_limit_mb={MEGABYTES}",
            f"-max_len={LONGEST}",
            f"-artifact_prefix={keep}/{name}-",
            "-len_control=0",
            "-mutate_depth=2",
            "-print_final_stats=1",
            f"-seed={seed}",
        ]
        command = [sys.executable, str(driver), name, str(corpus), *options]
        done = subprocess.run(command, capture_output=True, text=True, errors="replace")
    said = done.stdout + done.stderr
    count = re.search(r"number_of_executed_units:\s*(\d+)", said)
    found = Found(int(count[1]) if count else 0, "" if done.returncode == 0 else _fault(said))
    outcomes = re.findall(r"outcomes: (.*)", said)
    print(
        f"{name}: {found.inputs} inputs {outcomes[-1] if outcomes else ''} {found.fault}".rstrip()
    )
    return found


def _fault(said: str) -> str:
    """Return the end of what a fuzzer says of the input that it stopped at."""
    words = re.compile(r"Error|ERROR|Test unit|Unreadable")
    telling = [line for line in said.splitlines() if words.search(line)]
    return "\n  " + "\n  ".join(telling[-4:] or said.splitlines()[-4:])


if __name__ == "__main__":
    sys.exit(main())
