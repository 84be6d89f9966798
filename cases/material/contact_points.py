"""Points along contacts of blocks in the plane, where tractions act, with the length each stands
for."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointwave.cases.geometry.blocks import Facets
from jointwave.cases.geometry.cell_complex import NO_SET
from jointwave.cases.partition.blocks import Partition
from jointwave.cases.schema.joint_set import JointSet

#: Rule and number of points of a cut through intact rock.
CUT = ("gauss", 2)


@dataclass(frozen=True)
class ContactPoints:
    """Points of all contacts, those of one after the other.

    Attributes
    ----------
    contact : int array [p].
    arm : float array [p, 2, 2], m: from the centroids of blocks i and j to the point.
    length : float array [p], m, that a point stands for: its weight.
    """

    contact: np.ndarray
    arm: np.ndarray
    length: np.ndarray


def contact_points(
    partition: Partition,
    contacts: Facets,
    sets: Sequence[JointSet],
    shift: np.ndarray | tuple[float, float] = (0.0, 0.0),
) -> ContactPoints:
    """Return the points of contacts of a partition, by the rules of their joint sets.

    shift : by which blocks j stand elsewhere, m: across a periodic boundary.
    """
    rules: dict[int, tuple[str, int]] = {
        k: (one.point_rule, one.contact_points) for k, one in enumerate(sets)
    }
    rules[NO_SET] = CUT
    whose, places, weights = [], [], []
    for joint_set, (rule, count) in rules.items():
        own = np.flatnonzero(contacts.joint_set == joint_set)
        x, w = points_of(rule, count)
        whose.append(np.repeat(own, count))
        places.append(np.tile(x, len(own)))
        weights.append(np.tile(w, len(own)))
    contact = np.concatenate(whose)
    order = np.argsort(contact, kind="stable")
    contact, place = contact[order], np.concatenate(places)[order, None]
    at = contacts.start[contact] * (1 - place) + contacts.end[contact] * place
    i, j = contacts.blocks[contact].T
    arm = np.stack([at - partition.centroid[i], at - partition.centroid[j] - np.array(shift)], 1)
    return ContactPoints(contact, arm, np.concatenate(weights)[order] * contacts.area[contact])


def lever(rule: str, count: int) -> float:
    """Return how far the outermost points are from the centre of an edge, over half its length:
    1 - 1/n of n midpoints, which bear all that a face bears when it opens as far as it can."""
    return float(2 * points_of(rule, count)[0].max() - 1)


def points_of(rule: str, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return places and weights [count] of a rule on an edge from 0 to 1; weights add up to 1."""
    if rule == "gauss":
        x, w = np.polynomial.legendre.leggauss(count)
        return (1 + x) / 2, w / 2
    return (np.arange(count) + 0.5) / count, np.full(count, 1 / count)
