"""The joint laws again, in plain Python: what `joints.laws` compiles must equal this."""


def normal_traction(
    stiffness: float, viscosity: float, carries_tension: bool, gap: float, gap_rate: float
) -> float:
    """Return t_n (Pa, compression positive) of a spring and a dashpot in parallel.

    stiffness Pa/m, viscosity Pa s/m, gap m (open is positive), gap_rate m/s. A joint that does
    not carry tension carries nothing when open, and never pulls: Guo & Li (2002), equation (10).
    """
    t = -stiffness * gap - viscosity * gap_rate
    if carries_tension:
        return t
    if gap > 0:
        return 0.0
    return max(t, 0.0)
