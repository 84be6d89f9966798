"""Scenes of rock masses in few words."""

from jointwave.cases import load_tables


def rock(size, sets, law=(), **tables):
    """Return rock of 2600 kg/m3, 50 GPa and nu = 0.2 of this size, m, with joint sets of one law,
    of 1e10 and 4e9 Pa/m unless it or a set says otherwise; tables replaced."""
    law = {"normal_stiffness": 1e10, "shear_stiffness": 4e9} | dict(law)
    own = {
        "title": "rock",
        "domain": {"size": list(size)},
        "rock": {"density": 2600.0, "intact_modulus": 5e10, "intact_poisson": 0.2},
        "joint_sets": [{"name": f"set {k}"} | law | one for k, one in enumerate(sets)],
        "time": {"duration": 1e-3},
        "record": {"points": [[x / 2.1 for x in size]]},
    }
    return load_tables(own | tables)
