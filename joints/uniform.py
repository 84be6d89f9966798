"""One number where all joints are alike, an array where they differ, None for what is absent."""

import numpy as np

from joints.laws import Law


def uniform(values: np.ndarray) -> float | bool | np.ndarray:
    """Return the common value of an array if there is one, else the array itself."""
    same = values.size > 0 and (values == values[0]).all()
    return values[0].item() if same else np.ascontiguousarray(values)


def law(stiffness: np.ndarray, time_constant: np.ndarray | None, tension: np.ndarray) -> Law:
    """Return the law of joints with these properties [n], in its smallest form.

    stiffness Pa/m; time_constant eta in s, None without dashpots; tension: whether it is carried.
    """
    return Law(
        normal_stiffness=uniform(stiffness),
        normal_viscosity=None if time_constant is None else uniform(stiffness * time_constant),
        carries_tension=None if tension.all() else uniform(tension),
    )
