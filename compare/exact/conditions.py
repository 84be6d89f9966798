"""What the solutions ask of a scene before they hold."""

import numpy as np

from cases.calibrate import Properties


def rock_is_damped(p: Properties) -> bool:
    """Return whether the rock and its ordinary joints carry dashpots."""
    return bool(p.time_constant)


def joints_are_damped(p: Properties) -> bool:
    """Return whether any joint carries a dashpot; a damped rock has damped joints."""
    return p.joint_time_constant is not None and bool(p.joint_time_constant.any())


def bars_tension(p: Properties) -> bool:
    """Return whether any joint cannot be pulled."""
    return not bool(p.tension.all())


def excess_compliance(p: Properties) -> np.ndarray:
    """Return 1/K (m/Pa) that each joint [N - 1] adds to the homogenised bar, which holds one
    ordinary joint there already: 1/K'_n - 1/K'_n(regular), zero for a joint as stiff as the others.
    """
    same = np.isclose(p.stiffness, p.regular_stiffness, rtol=1e-9, atol=0)
    return np.where(same, 0.0, 1 / p.stiffness - 1 / p.regular_stiffness)


def has_interfaces(p: Properties) -> bool:
    """Return whether a soft layer differs in stiffness from the ordinary joints."""
    return bool(excess_compliance(p).any())
