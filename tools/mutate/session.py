"""A session of pytest that has collected its tests, in which every mutant is a fork.

So nothing is imported or collected twice: a fork gives the changed function its changed code and
runs the tests that call it, one after another, until one fails.
"""

import gc
import importlib
import os
import pickle
import select
import signal
import sys
import time
from argparse import Namespace
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from types import CodeType, FunctionType
from typing import Any, NamedTuple

import numpy as np
import pytest
from hypothesis import Phase, settings
from mutants import Mutant, mutants

MOST_TESTS = 60  # of one mutant
BUSY = 10.0  # times as long as by the processor a test may take by the clock


class Test(NamedTuple):
    """A test that passes: seconds of the processor, and the functions it calls by file and line."""

    seconds: float
    called: frozenset[tuple[str, int]]


class TooSlowError(BaseException):
    """A test takes too long; no code that it tests may catch this."""


def run(root: Path, modules: list[str], tests: list[str], asked: Namespace) -> int:
    """Collect the tests and try the mutants of all modules."""
    os.environ["PYTEST_DISABLE_PLUGIN_AUTOLOAD"] = "1"
    options = ["-p", "no:cacheprovider", "-qq", "-s", "--continue-on-collection-errors"]
    plugin = Mutants(root, modules, asked)
    pytest.main([*options, *tests], plugins=[plugin])
    return 1 if plugin.survived else 0


class Mutants:
    """A plugin of pytest that tries mutants in the place of tests."""

    def __init__(self, root: Path, modules: list[str], asked: Namespace):
        self.root, self.modules, self.asked = root, modules, asked
        self.failed = False
        self.survived = 0

    def pytest_sessionstart(self) -> None:
        """Let hypothesis try the same few examples every time, and not shrink those that fail."""
        phases = [Phase.explicit, Phase.generate]
        settings.register_profile(
            "mutate", deadline=None, phases=phases, derandomize=True, database=None, max_examples=25
        )
        settings.load_profile("mutate")

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Note a failure."""
        self.failed |= report.outcome == "failed"

    def pytest_runtestloop(self, session: pytest.Session) -> bool:
        """Learn what each test calls, then try the mutants."""
        np.seterr(all="ignore")  # as in kernels
        signal.signal(signal.SIGVTALRM, _too_slow)
        self.items = {item.nodeid: item for item in session.items}
        self.tests = self.learned()
        print(f"{len(self.tests)} of {len(self.items)} tests", flush=True)
        for path in self.modules:
            importlib.import_module(".".join(Path(path).with_suffix("").parts))
        self.functions: dict[tuple[str, int], list[FunctionType]] = {}
        for one in gc.get_objects():
            if isinstance(one, FunctionType):
                code = one.__code__
                at = code.co_filename, code.co_firstlineno
                self.functions.setdefault(at, []).append(one)
        whole: Counter[str] = Counter()
        for path in self.modules:
            whole += self.try_module(path)
        print("in all:", _spoken(whole))
        return True

    def learned(self) -> dict[str, Test]:
        """Return the tests that pass in time."""
        kept = self.asked.learned
        known = pickle.loads(kept.read_bytes()) if kept and kept.exists() else {}
        for name, item in self.items.items():
            if name not in known:
                known[name] = _forked(lambda item=item: self.traced(item), 5 * self.asked.slowest)
        if kept:
            kept.write_bytes(pickle.dumps(known))
        return {k: v for k, v in known.items() if isinstance(v, Test) and k in self.items}

    def traced(self, item: pytest.Item) -> Test | None:
        """Run one test and return what it calls; None where it fails."""
        called, base, began = set(), f"{self.root}/", time.process_time()

        def note(frame: Any, event: str, argument: Any) -> None:
            code = frame.f_code
            if event == "call" and code.co_filename.startswith(base):
                called.add((code.co_filename[len(base) :], code.co_firstlineno))

        sys.setprofile(note)
        self.take(item, self.asked.slowest)
        sys.setprofile(None)
        return None if self.failed else Test(time.process_time() - began, frozenset(called))

    def take(self, item: pytest.Item, seconds: float) -> None:
        """Run one test, in so many seconds of the processor at most."""
        signal.setitimer(signal.ITIMER_VIRTUAL, seconds)
        item.config.hook.pytest_runtest_protocol(item=item, nextitem=None)
        signal.setitimer(signal.ITIMER_VIRTUAL, 0)

    def try_module(self, path: str) -> Counter[str]:
        """Try the mutants of one module, and print those that survive."""
        source = (self.root / path).read_text(encoding="utf-8")
        found: Counter[str] = Counter()
        for one in mutants(path, source, self.asked.most, self.asked.seed):
            word = self.verdict(one)
            found[word] += 1
            if word == "survived":
                self.survived += 1
                print(f"{path}:{one.line}: {one.text}", flush=True)
        print(f"{path}: {_spoken(found)}", flush=True)
        return found

    def verdict(self, one: Mutant) -> str:
        """Return what becomes of a mutant: killed, survived or unusable."""
        calls = [k for k, test in self.tests.items() if (one.path, one.scope) in test.called]
        calls.sort(key=lambda k: self.tests[k].seconds)
        some, total = [], 0.0
        for k in calls[:MOST_TESTS]:
            total += self.tests[k].seconds
            if some and total > self.asked.seconds:
                break
            some.append(k)
        if not some:
            return "survived"
        found = _forked(lambda: self.tried(one, some), 20 + 10 * total)
        return found if isinstance(found, str) else "killed"  # by the clock, or all of the process

    def tried(self, one: Mutant, some: list[str]) -> str:
        """Return what becomes of a mutant under some tests."""
        name = str(self.root / one.path)
        try:
            code = _function(compile(one.tree, name, "exec"), one.scope)
            for function in self.functions[name, one.scope]:
                function.__code__ = code
        except (SyntaxError, ValueError, KeyError):
            return "unusable"
        for k in some:
            self.take(self.items[k], 5 + 5 * self.tests[k].seconds)
            if self.failed:
                return "killed"
        return "survived"


def _too_slow(number: int, frame: Any) -> None:
    raise TooSlowError


def _spoken(found: Counter[str]) -> str:
    return ", ".join(f"{n} {word}" for word, n in sorted(found.items())) or "no mutants"


def _function(code: CodeType, line: int) -> CodeType | None:
    """Return the code of the function whose first line it is."""
    for part in code.co_consts:
        if isinstance(part, CodeType):
            if part.co_firstlineno == line and "__qualname__" not in part.co_names:
                return part
            if found := _function(part, line):
                return found
    return None


def _forked(work: Callable[[], Any], seconds: float) -> Any:
    """Return what a function returns in a fork; None where it takes too long or dies."""
    read, write = os.pipe()
    child = os.fork()
    if child == 0:
        os.setsid()
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, 1)
        os.dup2(nowhere, 2)
        try:
            with os.fdopen(write, "wb") as stream:
                stream.write(pickle.dumps(work()))
        finally:
            os._exit(0)
    os.close(write)
    data, end = b"", time.monotonic() + BUSY * seconds
    with os.fdopen(read, "rb", buffering=0) as stream:
        while select.select([stream], [], [], max(0.0, end - time.monotonic()))[0]:
            part = stream.read(1 << 20)
            if not part:
                break
            data += part
        else:
            os.killpg(child, signal.SIGKILL)
    os.waitpid(child, 0)
    return pickle.loads(data) if data else None
