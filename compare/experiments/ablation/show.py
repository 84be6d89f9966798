"""What effects cost and are worth, on the terminal."""

from typing import Any

from compare.cli.terminal import print_json, say, show_table
from compare.experiments.ablation.ablation import Balance
from compare.experiments.ablation.section import WorthSection


def show_balances(found: list[Balance], section: WorthSection, as_json: bool) -> None:
    """Print what every effect costs and is worth, the dearest first, and what that says."""
    if as_json:
        print_json([_facts(one) for one in found])
        return
    for b, (heading, rows) in zip(found, section.table.groups.items(), strict=True):
        say(f"\n{b.title}", "bold")
        say(heading)
        show_table(section.table.header, rows)
    say("")
    for sentence in section.sentences:
        say(sentence)
    say(f"written: {', '.join(map(str, section.files))}")


def _facts(b: Balance) -> dict[str, Any]:
    return b._asdict() | {"effects": [w._asdict() for w in b.effects]}
