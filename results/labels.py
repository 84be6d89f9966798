"""Names and units of every variable and coordinate of a result, for labels of plots."""

import re

#: Dimensions of receivers, and the coordinates with their positions; z in space.
RECEIVERS = {
    "stress_y": ("stress_y",),
    "velocity_y": ("velocity_y",),
    "point": ("point_x", "point_y", "point_z"),
    "joint_point": ("joint_point_x", "joint_point_y", "joint_point_z"),
}
AXES = ("x", "y", "z")
#: Groups of quantities with the same unit and comparable amplitudes.
UNITS = (
    ("stress", "shear", "traction"),
    ("velocity",),
    ("displacement", "gap", "slip"),
    ("rotation",),
)
QUANTITIES = tuple(quantity for unit in UNITS for quantity in unit)
#: Peaks of a result, with their quantities.
PPV, PEAK_STRESS = "PPV", "peak stress"
PEAKS = {PPV: ("velocity",), PEAK_STRESS: ("stress", "shear")}

#: By name: (long name, unit; "" if it is not a physical quantity).
LABELS = {
    "time": ("time", "s"),
    "stress_y": ("y of the section", "m"),
    "velocity_y": ("y of the point", "m"),
    "joint_y": ("y of the joint", "m"),
    "point": ("number of the point", ""),
    "joint_point": ("number of the point of a joint", ""),
    **{f"point_{x}": (f"{x} of the point", "m") for x in AXES},
    **{f"joint_point_{x}": (f"{x} of the point of a joint", "m") for x in AXES},
    "stress_component": ("component of the stress", ""),
    "joint_axis": ("normal or shear", ""),
    "slip_axis": ("direction of the slip", ""),
    "traction": ("traction of the joint, compression positive", "Pa"),
    "gap": ("opening of the joint, positive when open", "m"),
    "slip": ("slip of the joint", "m"),
    "axis": ("direction of the motion", ""),
    "across": ("direction of the shear stress", ""),
    "term": ("term of the energy ledger", ""),
    "stress": ("stress, compression positive", "Pa"),
    "shear": ("shear stress on the far side", "Pa"),
    "velocity": ("velocity", "m/s"),
    "displacement": ("displacement", "m"),
    "rotation": ("rotation", "rad"),
    "energy": ("energy", "J"),
    "break_time": ("time at which the joint broke", "s"),
    "field_time": ("time of the snapshot", "s"),
    "component": ("direction", ""),
    "field_points": ("place of the node in the unloaded body", "m"),
    "field_cells": ("nodes of the cell, in VTK's order", ""),
    "field_block": ("number of the cell's block", ""),
    "field_displacement": ("displacement of the node", "m"),
    "field_velocity": ("velocity of the node", "m/s"),
    "field_stress": ("stress of the cell, compression positive", "Pa"),
    "field_joints": ("ends of the joint between two blocks", "m"),
    "field_slip": ("slip of the joint", "m"),
}


def label(name: str) -> dict[str, str]:
    """Return the attributes `long_name` and, for a physical quantity, `units` of a variable or of
    its error bound NAME_error."""
    long_name, unit = LABELS[name.removesuffix("_error")]
    if name.endswith("_error"):
        what = re.split(",| of | on ", long_name)[0]  # "shear stress" on the far side
        long_name = f"bound of the root-mean-square error of the {what}"
    return {"long_name": long_name} | ({"units": unit} if unit else {})
