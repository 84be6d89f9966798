"""What is verified: every test of the physics with its outcome, every scene with its misfits."""

import ast
from collections.abc import Iterator
from datetime import datetime
from pathlib import Path

from outcomes import Measured, Outcome, Results, read

import cases
from compare.scenes import SHIPPED, shipped

#: Folders of tests that hold physics to something exact, and what they hold.
FOLDERS = {
    "compare/exact": "Exact solutions, against one another and known values",
    "verification": "The continuum against closed forms",
    "joints": "The joint law",
    "dem": "Rigid blocks",
    "continuum": "The continuum",
    "compare/experiments/robustness": "Hard cases",
}
NOT_RUN = "not run"


def page(tests: Path, results: Path) -> str:
    """Return the tables; `tests` is the folder of the tests, `results` what a run of them left."""
    found = read(results)
    head = "| scene | pair | bound | misfit |\n| --- | --- | --- | --- |"
    parts = [_about(found, tests), "## Shipped scenes, held to their own bounds"]
    parts.append("\n".join([head, *_pairs(found)]))
    for folder, title in FOLDERS.items():
        files = sorted((tests / folder).rglob("test_*.py"))
        parts += [f"## {title}", "\n\n".join(_file(tests.parent, file, found) for file in files)]
    return "\n\n".join(parts)


def _about(found: Results | None, tests: Path) -> str:
    if found is None:
        return (
            '!!! warning "Not run"\n    No results of a test run were found when this page was '
            "built: it lists what is tested, without outcomes. `make test`, then `make docs`."
        )
    states = [s for outcome in found.tests.values() for s in outcome.counts.elements()]
    states += ["passed" if pair.holds else "failed" for pair in found.pairs.values()]
    counts = ", ".join(f"{states.count(s)} {s}" for s in ("passed", "failed", "skipped"))
    newer = _newest(tests.parent) > datetime.fromisoformat(found.when).timestamp()
    note = " The sources have changed since." if newer else ""
    kind = "warning" if newer or "failed" in states else "info"
    return f'!!! {kind} "{counts}"\n    The test run of {found.when}.{note}'


def _newest(root: Path) -> float:
    """Return when a source that decides the results last changed, s since 1970."""
    folders = ("cases", "results", "numerics", "joints", "dem", "continuum", "compare", "tests")
    files = (f for name in folders for s in ("py", "toml") for f in (root / name).rglob(f"*.{s}"))
    return max(file.stat().st_mtime for file in files)


def _pairs(found: Results | None) -> Iterator[str]:
    measured = found.pairs if found else {}
    for path in shipped():
        file = path.relative_to(SHIPPED.parent).as_posix()
        ran = any(place == file for place, _ in measured)
        for scene in cases.load(path):
            for pair, bound in scene.expect.items():
                one = measured.get((file, f"{scene.name}: {pair}" if scene.name else pair))
                if ran and one is None:
                    continue  # it does not apply to this variant
                variant = f", {scene.name}" if scene.name else ""
                name = f"{path.parent.name}/{path.stem}{variant}"
                yield f"| {name} | {pair} | {bound:g} | {_misfit(one)} |"


def _misfit(one: Measured | None) -> str:
    if one is None:
        return NOT_RUN
    value = "" if one.misfit is None else f"{one.misfit:.2g}"
    return value if one.holds else f"**{value} fails**"


def _file(root: Path, file: Path, found: Results | None) -> str:
    tree = ast.parse(file.read_text(encoding="utf-8"))
    place = file.relative_to(root).as_posix()
    rows = [
        f"    | {_first(node)} | {_outcome(found, place, node.name)} |"
        for node in tree.body
        if isinstance(node, ast.FunctionDef) and node.name.startswith("test_")
    ]
    head = [f'??? note "{_first(tree)}"', f"    `{place}`", ""]
    return "\n".join([*head, "    | test | outcome |", "    | --- | --- |", *rows])


def _first(node) -> str:
    """Return the first paragraph of a docstring in one line; of a test without, its name."""
    text = ast.get_docstring(node) or node.name.removeprefix("test_").replace("_", " ")
    return " ".join(text.split("\n\n")[0].split()).replace("|", "\\|").replace('"', "'")


def _outcome(found: Results | None, place: str, name: str) -> str:
    outcome: Outcome | None = found.tests.get((place, name)) if found else None
    if outcome is None:
        return NOT_RUN
    counts = ", ".join(
        f"{n} {state}" if state != "failed" else f"**{n} failed**"
        for state, n in sorted(outcome.counts.items(), reverse=True)
    )
    return f"{counts} ({outcome.seconds:.2g} s)"
