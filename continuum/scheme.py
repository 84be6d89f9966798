"""Explicit or implicit steps: which a scene asks for, or which cost less, and why."""

from __future__ import annotations

from math import ceil
from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import reverse_cuthill_mckee

from jointwave.cases.errors import SceneError
from jointwave.cases.sampling import MOST_STEPS, Clock, clock, sample_times
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.cases.schema.scene import Scene
from jointwave.continuum.build import Discrete, operators
from jointwave.continuum.plane.discrete import PlaneDiscrete
from jointwave.continuum.size import resolved_period

#: How many explicit steps one implicit step must replace before its cost is looked into: it solves
#: an equation with several times the entries of the stiffness, and is not vectorised over blocks.
STEPS_PER_IMPLICIT = 20

#: Entries that a step takes in a second: of the block operators, and of triangular factors.
OPERATOR_RATE, FACTOR_RATE = 3e9, 3e8
#: Operations a second of a factorisation, and what an implicit step costs besides, s.
FACTORISATION_RATE, OVERHEAD = 1e9, 5e-4
ITERATIONS = 3  # of Newton's method where joints open, slide or break


class Choice(NamedTuple):
    """How a scene is stepped: "explicit" or "implicit", its clock, and the reason in a phrase."""

    scheme: str
    time: Clock
    reason: str


def choose(scene: Scene | RockMass, discrete: Discrete | PlaneDiscrete, critical: float) -> Choice:
    """Return the scheme of a scene; critical : the critical step of explicit steps, s.

    Raises SceneError for a step that cannot be taken.
    """
    numerics = scene.numerics.continuum
    if numerics.scheme == "explicit":
        return _explicit(scene, critical, "numerics.continuum.scheme = 'explicit'")
    if numerics.scheme == "implicit":
        return _implicit(scene, "numerics.continuum.scheme = 'implicit'")
    if getattr(numerics, "mass", None) == "consistent":
        return _implicit(scene, "a consistent mass is not diagonal")
    return _cheaper(scene, discrete, critical)


def _explicit(scene: Scene | RockMass, critical: float, reason: str) -> Choice:
    numerics = scene.numerics.continuum
    fraction, allowed = numerics.step_fraction, numerics.allow_unstable
    return Choice("explicit", clock(scene, critical, fraction, allowed, "continuum"), reason)


def _implicit(scene: Scene | RockMass, reason: str) -> Choice:
    wanted = resolved_period(scene) / scene.numerics.continuum.steps_per_period
    stride = max(1, ceil(scene.interval / wanted * (1 - 1e-12)))
    time = Clock(scene.interval / stride, stride, len(sample_times(scene)))
    if time.steps > MOST_STEPS:
        key = "numerics.continuum.steps_per_period"
        value = scene.numerics.continuum.steps_per_period
        raise SceneError(scene.where, key, value, f"gives {time.steps:.3g} steps")
    return Choice("implicit", time, reason)


def _cheaper(
    scene: Scene | RockMass, discrete: Discrete | PlaneDiscrete, critical: float
) -> Choice:
    """Return the faster scheme, by operation counts."""
    implicit = _implicit(scene, "")
    many = scene.time.duration / (critical * scene.numerics.continuum.step_fraction)
    few = implicit.time.steps
    if many < STEPS_PER_IMPLICIT * few:
        few_more = f"{STEPS_PER_IMPLICIT} x {few:,} implicit ones"
        reason = f"{many:,.0f} explicit steps are fewer than {few_more}"
        return _explicit(scene, critical, reason)
    explicit_cost, implicit_cost = _costs(discrete, many, few)
    costs = f"{many:,.0f} explicit steps, some {explicit_cost:.2g} s, against {few:,} implicit ones"
    reason = f"{costs}, some {implicit_cost:.2g} s"
    if explicit_cost <= implicit_cost:
        return _explicit(scene, critical, reason)
    return implicit._replace(reason=reason)


def _costs(discrete: Discrete | PlaneDiscrete, many: float, few: int) -> tuple[float, float]:
    """Return guesses of the seconds that so many explicit and so few implicit steps take.

    They are those of one process, so that any number of them comes to the same choice.
    """
    communicator, found = discrete.body.communicator, (0.0, 0.0)
    stiffness, viscosity = operators(discrete)
    none = csr_matrix(stiffness.shape)
    shares = stiffness, none if viscosity is None else viscosity
    bends = communicator.any(_bends(discrete))
    stiffness, viscosity = (communicator.assembled(share) for share in shares)
    if stiffness is not None and viscosity is not None:
        entries = stiffness.nnz + viscosity.nnz + 10 * stiffness.shape[0]
        found = many * entries / OPERATOR_RATE, _implicit_seconds(stiffness, bends, few)
    return communicator.same(found)


def _bends(discrete: Discrete | PlaneDiscrete) -> bool:
    """Return whether joints open, slide, break or close nonlinearly."""
    law = None if discrete.joints is None else discrete.joints.law
    return law is not None and any(
        value is not None and not name.endswith(("stiffness", "viscosity"))
        for name, value in law._asdict().items()
    )


def _implicit_seconds(stiffness: csr_matrix, bends: bool, steps: int) -> float:
    entries = factor_entries(stiffness)
    solve = entries / FACTOR_RATE + OVERHEAD
    factorise = entries**2 / max(stiffness.shape[0], 1) / FACTORISATION_RATE
    return steps * ITERATIONS * (solve + factorise) if bends else steps * solve + factorise


def factor_entries(matrix: csr_matrix) -> int:
    """Return how many entries triangular factors have within the envelope of a narrow numbering,
    which for a row of blocks is close to the fewest."""
    order = reverse_cuthill_mckee(matrix, symmetric_mode=True)
    narrow = matrix[order][:, order].tocoo()
    reach = np.zeros(matrix.shape[0], dtype=np.int64)
    np.maximum.at(reach, narrow.row, narrow.row - narrow.col)
    return int(2 * reach.sum() + reach.size)
