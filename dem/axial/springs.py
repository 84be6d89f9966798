"""Forces of the joints without dashpots, for states at rest and for steps without damping."""

from jointwave.joints.formula import formula
from jointwave.joints.law import law_of
from jointwave.joints.normal import spring_traction


@formula
def spring_forces(parts, area, laws, u, opening, force):
    """Write the force of every joint (N, compression positive) into contacts 1 .. N - 1.

    opening : of each joint, the largest so far, m; any array without softening.
    """
    law = law_of(laws, 0)
    for j in range(u.size - 1):
        if parts.varied:
            law = law_of(laws, j)
        gap = u[j + 1] - u[j]
        force[j + 1] = area * spring_traction(law, parts, gap, max(opening[j], gap))
