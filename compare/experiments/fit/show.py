"""The output of `jointwave fit`."""

import math
import shlex
from pathlib import Path

from compare.cli.terminal import say, show_numbers
from compare.experiments.fit.result import Estimate, Fit


def show_fit(found: Fit, scene: str, changes: list[str], files: list[Path]) -> None:
    """Print values with intervals, correlations, misfits, and the command to continue.

    changes : those made to the scene, KEY=VALUE.
    """
    worst = max(found.waveforms, key=lambda one: one.after)
    say(
        f"{found.scene.title} {found.scene.name}".strip() + f", fitted by {found.solver} in "
        f"{found.trials} solutions",
        "bold",
    )
    say(
        f"misfit {found.before:.3%} before, {found.after:.3%} after"
        + (f"; worst {worst.name}, {worst.place}" if len(found.waveforms) > 1 else "")
    )
    show_numbers(
        ["key", "value", "from", "to", "", "start"],
        {"values, with 95 % intervals": [_cells(e) for e in found.estimates]},
    )
    if len(found.estimates) > 1:
        names = [e.key for e in found.estimates]
        rows = [
            [name, *(f"{c:+.3f}" for c in row)]
            for name, row in zip(names, found.correlation, strict=True)
        ]
        show_numbers(["", *names], {"correlations": rows})
    for note in found.notes:
        say(f"note: {note}")
    say("The intervals assume the model: jointwave compare shows how far models differ.")
    arguments = ["jointwave", "compare", scene, "--variant", found.scene.name]
    for setting in [*changes, *found.settings]:
        arguments += ["--set", setting]
    say(f"run it: {shlex.join(arguments)}")
    for path in files:
        say(f"wrote {path}")


def _cells(e: Estimate) -> list[str]:
    ends = ["-" if not math.isfinite(x) else _digits(x, e) for x in (e.low, e.high)]
    if not math.isfinite(e.high):
        ends = ["not", "determined"]
    return [e.key, _digits(e.value, e), *ends, e.unit, f"{e.start:.6g}"]


def _digits(value: float, e: Estimate) -> str:
    """Return a value with two digits more than its interval justifies."""
    width = abs(e.high - e.low) / 2
    if not math.isfinite(width) or width == 0 or value == 0:
        return f"{value:.6g}"
    digits = math.ceil(math.log10(max(abs(value), width) / width)) + 2
    return f"{value:.{min(max(digits, 3), 10)}g}"
