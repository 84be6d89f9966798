"""One number where all joints are alike, an array where they differ, None for what is absent."""

from typing import overload

import numpy as np

from joints.law import Law


@overload
def uniform(values: None) -> None: ...
@overload
def uniform(values: np.ndarray) -> float | bool | np.ndarray: ...
def uniform(values: np.ndarray | None) -> float | bool | np.ndarray | None:
    """Return the common value of an array if there is one, else the array itself; None of None."""
    if values is None:
        return None
    same = values.size > 0 and (values == values[0]).all()
    return values[0].item() if same else np.ascontiguousarray(values)


def law(
    stiffness: np.ndarray,
    time_constant: np.ndarray | None,
    tension: np.ndarray,
    *,
    shear_stiffness: np.ndarray | None = None,
    **strengths: np.ndarray | None,
) -> Law:
    """Return the law of joints with these properties [n], in its smallest form.

    stiffness, shear_stiffness Pa/m; time_constant eta of both in s, None without dashpots;
    tension: whether it is carried; strengths: the other fields of the law, None where no joint has
    them.
    """

    def viscosity(stiffness: np.ndarray | None) -> np.ndarray | None:
        return None if stiffness is None or time_constant is None else stiffness * time_constant

    return Law(
        normal_stiffness=uniform(stiffness),
        normal_viscosity=uniform(viscosity(stiffness)),
        carries_tension=None if tension.all() else uniform(tension),
        shear_stiffness=uniform(shear_stiffness),
        shear_viscosity=uniform(viscosity(shear_stiffness)),
        **{name: uniform(values) for name, values in strengths.items()},
    )
