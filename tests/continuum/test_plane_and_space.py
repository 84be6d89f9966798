"""Rock masses in space against the same ones in the plane, turned, and against exact waves."""

import numpy as np

from jointwave.cases.read import load_tables

TURNED = {"left": "front", "right": "back", "front": "right", "back": "left"}  # by 90 degrees


def turned(x, y, z):
    """Return a place in a box 2 m deep, turned about the vertical by 90 degrees."""
    return [2.0 - y, x, z]


def scene(dim, tables, place=lambda x, y, z: [x, y, z], sides=None):
    """Return blocks of 2 m x 1 m, 2 m deep, in 4 m x 3 m, that stand on a quiet side, with
    smooth faces in front and behind; a force from the left and a wave from below act."""
    flat = dim == 2

    def at(x, z):
        return [x, z] if flat else place(x, 0.7, z)

    def size(x, z):
        return [x, z] if flat else [*np.abs(np.subtract(place(x, 2.0, z), place(0, 0, 0))).tolist()]

    held = {"bottom": "quiet", "top": "free", "left": "quiet", "right": "roller"}
    held |= {} if flat else {"front": "roller", "back": "roller"}
    names = sides or {}
    law = {"normal_stiffness": 2e10, "shear_stiffness": 8e9}
    beds = {"name": "bed", "dip": 0.0, "spacing": 1.0, "through": at(0.0, 1.0), **law}
    heads = {"name": "head", "dip": 90.0, "through": at(2.0, 0.0), **law}
    if not flat:
        heads["dip_direction"] = 0.0 if sides else 90.0
    way = np.subtract(place(0.6, 0.0, 0.8), place(0.0, 0.0, 0.0))
    load = {"kind": "traction", "side": names.get("left", "left"), "quantity": "stress"}
    load |= {"shape": "ricker", "amplitude": 1e6, "period": 2e-3}
    load |= {"direction": [0.6, 0.8] if flat else way.tolist()}
    table = {
        "title": "a slice",
        "domain": {"size": size(4.0, 3.0)},
        "rock": {"density": 2600.0, "intact_modulus": 5e10, "intact_poisson": 0.2},
        "joint_sets": [beds, heads],
        "loads": [load],
        "boundaries": {names.get(side, side): kind for side, kind in held.items()},
        "time": {"duration": 4e-3},
        "record": {"points": [at(1.1, 0.6), at(3.3, 2.4)], "joints": [at(1.0, 1.0)]},
        "numerics": {"continuum": {"size": 1.0, "order": 2}},
    }
    return load_tables(table | tables)
