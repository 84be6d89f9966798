"""What effects cost and are worth, on the terminal."""

from typing import Any

from compare.terminal import print_json, say, show_table
from compare.worth import Balance, Worth


def show_balances(found: list[Balance], as_json: bool) -> None:
    """Print what every effect costs and is worth, the dearest first."""
    if as_json:
        print_json([_balance_facts(one) for one in found])
        return
    columns = ["effect", "ns a block-step", "share, %", "misfit without, %", "why it stays"]
    for one in found:
        say(f"{one.scene.title}{f', {one.scene.name}' if one.scene.name else ''}")
        ordered = sorted(one.effects, key=lambda w: -w.cost if w.cost == w.cost else 0.0)
        show_table(columns, [_worth_cells(w) for w in ordered])
        say(
            f"a step of a block takes {one.own:.2g} ns, {100 * one.own / one.everything:.2g} % of "
            f"the {one.everything:.2g} ns with every effect"
        )


def _worth_cells(w: Worth) -> list[str]:
    if w.reason:
        return [w.effect, "", "", "", w.reason]
    return [w.effect, f"{w.cost:.2g}", f"{100 * w.share:.2g}", f"{100 * w.misfit:.3g}", ""]


def _balance_facts(one: Balance) -> dict[str, Any]:
    return {
        "variant": one.scene.name,
        "ns_block_step": one.own,
        "ns_block_step_with_everything": one.everything,
        "effects": [
            {k: None if v != v else v for k, v in w._asdict().items()} for w in one.effects
        ],
    }
