"""The joint law of contacts, one column for each kind, and the contact points of each column."""

from collections.abc import Sequence
from itertools import product
from typing import Any, NamedTuple

import numpy as np

from jointwave.cases.material.contact_points import bending, points_of, vertex_points
from jointwave.cases.material.properties import strength_of
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.schema.joint import JointLaw
from jointwave.dem.contacts.faces import Contacts
from jointwave.joints.law import Law, law, stiffest

#: Name of a rule of points, and their number along each tangent.
Rule = tuple[str, int | None]


class Columns(NamedTuple):
    """The joint law in columns, with the initial K_n and K_s of each [columns], Pa/m.

    stiffest : K_n and K_s at the largest closure in reach, sliding dilatant joints included
    [2, columns], Pa/m. viscosity : largest, normal and in shear [2, columns], Pa s/m; None without
    dashpots. rules : of contact points, one for all or one a column. fails : whether joints can
    open, slip or break, point by point.
    """

    law: Law
    normal: np.ndarray
    shear: np.ndarray
    stiffest: np.ndarray
    viscosity: np.ndarray | None
    rules: list[Rule]
    fails: bool

    @property
    def bending(self) -> np.ndarray:
        """Second moments of the contact points over those of the face, by column."""
        return np.resize([bending(*rule) for rule in self.rules], len(self.normal))


def columns_of(
    scene: AnyScene,
    laws: Sequence[JointLaw],
    which: np.ndarray,
    stiffness: np.ndarray,
    *,
    eta: np.ndarray | None,
    rock: np.ndarray | None,
    rules: list[Rule],
    shears: bool = True,
) -> Columns:
    """Return the joint law in columns; which : index in `laws` of each column [columns].

    stiffness : normal and in shear [2, columns], Pa/m. eta : viscosity over stiffness, s; None
    without dashpots. rock : the rock's part of the compliance, m/Pa, and its eta, s [2, columns];
    None where no joint stiffens. rules : as in `Columns`. shears : whether motion is along joints.
    """
    (normal, shear), tension = stiffness, np.array([one.tension is not False for one in laws])
    strengths, tension = strength_of(laws, which).strengths(shears), tension[which]
    across = shear if shears else None
    if rock is not None:
        strengths |= {"rock_compliance": rock[0], "rock_time_constant": rock[1]}
    found = law(normal, eta, tension, shear_stiffness=across, **strengths)
    most, fails = stiffest(found, scene), not tension.all() or bool(strengths)

    def each(*values: Any) -> np.ndarray:
        return np.array([np.resize(0.0 if one is None else one, len(normal)) for one in values])

    viscous = None if eta is None else each(most.normal_viscosity, most.shear_viscosity)
    stiff = each(most.normal_stiffness, most.shear_stiffness)
    return Columns(found, normal, shear * shears, stiff, viscous, rules, fails)


def points_on(contacts: Contacts, rules: list[Rule]) -> np.ndarray:
    """Return the points of all contacts [c, points, d]: places, m, from the centre along the
    tangents, and areas; contacts with fewer points have some of zero area.

    rules : one for all or one a column.
    """
    which, parts = np.minimum(contacts.column, len(rules) - 1), []
    for k, (rule, number) in enumerate(rules):
        own = np.flatnonzero(which == k)
        if rule == "vertices" and contacts.frame.shape[1] > 1:
            parts.append((own, *vertex_points(_corners(contacts, own), contacts.spread[own])))
        else:
            parts.append((own, *_grid(contacts.spread[own], *points_of(rule, number))))
    most = max(shares.shape[1] for _, _, shares in parts)
    found = np.zeros((len(contacts.area), most, contacts.frame.shape[1]))
    for own, places, shares in parts:
        found[own, : shares.shape[1], :-1] = places
        found[own, : shares.shape[1], -1] = contacts.area[own, None] * shares
    return found


def _grid(spread: np.ndarray, x: np.ndarray, w: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return places [c, points, d - 1] and area fractions [c, points] of a tensor-product rule with
    places x and weights w on [0, 1], on parallelograms with these second moments."""
    axes = spread.shape[1]
    variance, turn = np.linalg.eigh(spread)
    half = (turn * np.sqrt(3 * np.maximum(variance, 0.0))[:, None]) @ turn.swapaxes(1, 2)
    places = np.array(list(product(2 * x - 1, repeat=axes)))
    shares = [np.prod(one) for one in product(w, repeat=axes)]
    return places @ half, np.tile(shares, (len(spread), 1))


def _corners(contacts: Contacts, own: np.ndarray) -> np.ndarray:
    """Return the corners of contacts, from the centre along the tangents [c, k, d - 1], m; the last
    corner is repeated to fill the array."""
    corners, first = contacts.outlines
    begin, end = first[own, None], first[own + 1, None]
    at = np.minimum(begin + np.arange((end - begin).max(initial=1)), end - 1)
    away = corners[at] - contacts.centre[own, None]
    return away @ contacts.frame[own, 1:].swapaxes(1, 2)
