"""The claims of Guo & Li (2002), figure by figure, measured on every engine.

A claim holds or it does not, by the numbers in its sentence; one that fails is shown like any
other. The distances of the engines from exact solutions are in the tables of misfits.
"""

from collections.abc import Callable

from jointwave.compare.misfit.pairs import Comparison
from jointwave.compare.report.claims import joints, pillar, travel
from jointwave.compare.report.claims.claim import Claim

#: By figure: what it must show, and the function that measures it on the scene and its variants.
CLAIMS: dict[int, dict[str, Callable[[list[Comparison]], Claim]]] = {
    2: {"one sine cycle": pillar.one_sine_cycle},
    3: {
        "incident, first and second reflected pulse": pillar.three_pulses,
        "amplitude falls with distance": pillar.falls_with_distance,
        "amplitude falls with damping": pillar.falls_with_damping,
    },
    4: {
        "travel": travel.travels,
        "reflection": travel.reflection,
        "superposition": travel.superposition,
    },
    5: {
        "no reflected pulse with the non-reflecting end": travel.quiet_end,
        "the remaining reflection is due to the end block's mass": travel.left_by_the_quiet_end,
        "the matched end reflects least": travel.matched_end,
    },
    6: {
        "large damping: broader": pillar.broader,
        "large damping: second half-cycle weaker": pillar.second_half_weaker,
    },
    7: {
        "reflection in front of the layer": joints.reflects_in_front,
        "smaller and later behind the layer": joints.smaller_and_later,
    },
    8: {
        "reflection in front of the layer": joints.reflects_in_front,
        "smaller and later behind the layer": joints.smaller_and_later,
    },
    9: {"the tensile half-cycle is cut": joints.tension_is_cut},
    10: {
        "blocks separate": joints.blocks_separate,
        "blocks coast, the velocity tends to zero behind the pulse": joints.blocks_coast,
    },
}


def claims_of(figure: int | None, comparisons: list[Comparison]) -> list[Claim]:
    """Return the claims of a figure of the paper; none for any other scene."""
    table = CLAIMS.get(figure or 0, {})
    return [measure(comparisons)._replace(claim=text) for text, measure in table.items()]
