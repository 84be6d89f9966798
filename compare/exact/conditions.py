"""What the solutions ask of a scene before they hold."""

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


def has_interfaces(p: Properties) -> bool:
    """Return whether a soft layer differs in stiffness from the ordinary joints."""
    return bool(p.excess_compliance.any())
