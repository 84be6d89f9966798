"""Rock masses in the plane in other axes."""

import numpy as np

from jointwave.cases import load_tables


def turned(scene, matrix):
    """Return a scene between quiet sides mapped by a rotation or reflection [2, 2]."""
    flips, angle = np.linalg.det(matrix), np.degrees(np.arctan(matrix[1, 0] / matrix[0, 0]))

    def place(points):
        return (np.array(points) @ matrix.T).tolist()

    own = scene.model_dump(exclude_none=True, exclude_unset=True)
    for one in own.get("joint_sets", []):
        one |= {"dip": flips * one["dip"] + angle, "through": place(one["through"])}
    for one in own.get("waves", []):
        one |= {key: place(one[key]) for key in ("direction", "through")}
    if scene.prestress is not None:
        stress = matrix @ scene.prestress.tensor @ matrix.T
        own["prestress"] = {"xx": stress[0, 0], "yy": stress[1, 1], "xy": stress[0, 1]}
    openings = [place(one) for one in scene.domain.openings]
    own["domain"] = {"outline": place(scene.domain.corners), "openings": openings}
    own["boundaries"] = {"outline": "quiet"}
    own["record"] |= {key: place(getattr(scene.record, key)) for key in ("points", "joints")}
    return load_tables(own)
