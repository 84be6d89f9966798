"""The results of a test run, from the file that `make test` leaves."""

import re
from collections import Counter
from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree


class Outcome(NamedTuple):
    """How the cases of one test ended (passed, failed, skipped), and what they took, s."""

    counts: Counter
    seconds: float


class Measured(NamedTuple):
    """One pair of a scene: its misfit, None where nothing was measured, and whether it holds."""

    misfit: float | None
    holds: bool


class Results(NamedTuple):
    """A test run.

    when : as the file has it. tests : by (file, function). pairs : by (file, name of the pair).
    """

    when: str
    tests: dict[tuple[str, str], Outcome]
    pairs: dict[tuple[str, str], Measured]


def read(path: Path) -> Results | None:
    """Return the results of a JUnit file; None where there is none."""
    if not path.is_file():
        return None
    suite = next(ElementTree.parse(path).getroot().iter("testsuite"))
    tests: dict[tuple[str, str], Outcome] = {}
    pairs = {}
    for case in suite.iter("testcase"):
        dotted, name = case.attrib["classname"], case.attrib["name"]  # without a suffix .py
        suffix = ".toml" if dotted.endswith(".toml") else ".py"
        place = dotted.removesuffix(".toml").replace(".", "/") + suffix
        if place.endswith(".toml"):
            values = {p.attrib["name"]: p.attrib["value"] for p in case.iter("property")}
            found = float(values["misfit"]) if "misfit" in values else None
            pairs[place, name] = Measured(found, _state(case) == "passed")
            continue
        key = place, re.sub(r"\[.*", "", name, flags=re.DOTALL)
        before = tests.get(key, Outcome(Counter(), 0.0))
        counts = before.counts + Counter([_state(case)])
        tests[key] = Outcome(counts, before.seconds + float(case.attrib["time"]))
    return Results(suite.attrib.get("timestamp", "")[:19], tests, pairs)


def _state(case: ElementTree.Element) -> str:
    if case.find("failure") is not None or case.find("error") is not None:
        return "failed"
    return "skipped" if case.find("skipped") is not None else "passed"
