"""An end of deformable rock on a dashpot beta Z, Z the impedance of the rock, at normal incidence.

The particle velocity of a reflected wave is (1 - beta)/(1 + beta) of the incident one, its stress
the opposite (Lysmer & Kuhlemeyer, J. Eng. Mech. Div. ASCE 95, 1969): beta = 1 is the quiet end, 0
the free one, infinity the fixed one.
"""


def reflection(beta: float) -> float:
    """Return the reflected particle velocity over the incident one."""
    return (1 - beta) / (1 + beta)
