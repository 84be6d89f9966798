"""Output of `jointwave doctor`."""

from math import isnan

from compare.cli.diagnostics.accuracy import Check
from compare.cli.diagnostics.doctor import Health
from compare.cli.terminal import print_json, say, show_table

COLOURS = {"missing": "yellow", "broken": "bold red"}


def show_health(found: Health, as_json: bool) -> None:
    """Print every part, and what the engines' checks came to."""
    if as_json:
        checks = [{**check._asdict(), "holds": check.holds} for check in found.checks]
        parts = [part._asdict() for part in found.parts]
        print_json({"parts": parts, "self_check": checks, "well": found.is_well})
        return
    rows = [[p.group, p.part, p.state, _said(p.found, p.hint)] for p in found.parts]
    show_table(["", "part", "state", ""], rows, [COLOURS.get(p.state, "") for p in found.parts])
    say("")
    for check in found.checks:
        say(_sentence(check), "green" if check.holds else "bold red")
    say("all checks pass" if found.is_well else "a check fails: see the self-check above")


def _said(found: str, hint: str) -> str:
    return f"{found}; {hint}" if hint else found


def _sentence(check: Check) -> str:
    verdict = "holds" if check.holds else "FAILS"
    if isnan(check.misfit):
        return f"self-check {check.pair}: {verdict}, {check.reason}"
    return (
        f"self-check {check.pair}: {verdict}, relative L2 misfit {check.misfit:.3g}, "
        f"at most {check.bound:g}, in {check.seconds:.1f} s"
    )
