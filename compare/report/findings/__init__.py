"""Findings of each figure of Guo & Li (2002), measured on every engine and judged.

A finding holds or it does not, by the numbers in its sentence; none is left out when it fails.
What lies between the engines and the exact solutions is in the tables of misfits.
"""

from collections.abc import Callable

from compare.misfit.pairs import Comparison
from compare.report.findings import joints, pillar, travel
from compare.report.findings.finding import Finding

__all__ = ["FINDINGS", "Finding", "findings"]

#: By figure of the paper: what it must show.
FINDINGS: dict[int, tuple[Callable[[list[Comparison]], Finding], ...]] = {
    2: (pillar.one_sine_cycle,),
    3: (pillar.three_pulses, pillar.falls_with_distance, pillar.falls_with_damping),
    4: (travel.travels, travel.reflection, travel.superposition),
    5: (travel.quiet_end, travel.what_the_quiet_end_leaves, travel.matched_end),
    6: (pillar.broader, pillar.second_half_weaker),
    7: (joints.reflects_in_front, joints.smaller_and_later),
    8: (joints.reflects_in_front, joints.smaller_and_later),
    9: (joints.tension_is_cut,),
    10: (joints.blocks_separate, joints.blocks_coast),
}


def findings(figure: int, comparisons: list[Comparison]) -> list[Finding]:
    """Return the findings of one figure of the paper; none for a figure without claims.

    `comparisons` are the scene as it stands and its variants, in the order of the file.
    """
    return [find(comparisons) for find in FINDINGS.get(figure, ())]
