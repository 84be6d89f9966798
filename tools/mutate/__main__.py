"""`make mutate`: small faults put into the code one at a time, each of which a test should find.

    usage: python tools/mutate [--most 12] [--seed 1] [--tests PATH...] [--learned FILE] [PATH...]

A mutant is a function with one operator, number, name, index, condition or statement changed. It is
held to the tests that call this function, the fastest first, for some seconds. Kernels run as plain
Python, and tests that take too long so are left out. What no test finds is printed: it is either
equivalent, or a test is missing.
"""

import argparse
import os
import sys
from pathlib import Path

import plain

ROOT = Path(__file__).parents[2]
#: The tests of each package, as plain Python in a few minutes.
TESTS = {
    "cases": ["tests/cases", "tests/test_bad_scenes.py"],
    "results": ["tests/results"],
    "numerics": ["tests/numerics"],
    "joints": ["tests/joints", "tests/numerics"],
    "compare/exact": ["tests/compare/exact"],
    "dem": ["tests/dem"],
    "continuum": ["tests/continuum"],
}


def main() -> int:
    """Try the mutants of some modules; 1 where any survives."""
    parser = argparse.ArgumentParser(prog="tools/mutate")
    parser.add_argument("paths", nargs="*", default=["cases", "joints"])
    parser.add_argument("--tests", nargs="+", help="default: those of the modules' packages")
    parser.add_argument("--most", type=int, default=12, help="mutants of a module, by chance")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--seconds", type=float, default=5.0, help="that a mutant's tests may take")
    parser.add_argument("--slowest", type=float, default=2.0, help="s, test that is not left out")
    parser.add_argument("--learned", type=Path, help="keeps what tests call for the next time")
    asked = parser.parse_args()
    modules = [m for path in asked.paths for m in _modules(ROOT / path)]
    packages = [p for p in TESTS if any(m.startswith(f"{p}/") for m in modules)]
    tests = asked.tests or [t for p in packages for t in TESTS[p]]
    os.chdir(ROOT)
    sys.meta_path.insert(0, plain.Finder(ROOT))
    from session import run  # it imports numpy and pytest, which must find our modules changed

    return run(ROOT, modules, tests, asked)


def _modules(path: Path) -> list[str]:
    files = sorted(path.rglob("*.py")) if path.is_dir() else [path]
    return [str(f.relative_to(ROOT)) for f in files if "examples" not in f.parts]


if __name__ == "__main__":
    sys.exit(main())
