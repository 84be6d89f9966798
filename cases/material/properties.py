"""Properties of a pillar: rock between its joints, and stiffness, damping and strength of each."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import reduce

import numpy as np

from jointwave.cases.material.jointed_rock import JointedRock
from jointwave.cases.schema.joint import JointLaw
from jointwave.cases.schema.law_parts import PARTS, UNLIMITED, tangent

#: The keys of slip, without which no joint slides.
SLIP = ("friction_angle", "cohesion", "residual_cohesion")
#: Parameters that act also normal to a joint; axial motion ignores the others.
ACROSS = tuple(name for part in PARTS if not part.along for name in part.without)
#: All parameters, by their names in `joints.law.Law`.
NAMES = ("friction", "cohesion", "residual_cohesion", *(n for part in PARTS for n in part.without))


@dataclass(frozen=True)
class Strength:
    """Strength and closure parameters of the joints, by their names in `joints.law.Law`. Each is an
    attribute: a float array [N - 1], or None if no joint has it."""

    given: dict[str, np.ndarray] = field(default_factory=dict)

    def __getattr__(self, name: str) -> np.ndarray | None:
        if name in NAMES:
            return self.given.get(name)
        raise AttributeError(name)

    def strengths(
        self, shears: bool = True, joint: np.ndarray | slice = np.s_[:]
    ) -> dict[str, np.ndarray | None]:
        """Return the parameters of some joints by name; shears : include those along joints."""
        names = NAMES if shears else ACROSS
        return {name: self.given[name][joint] for name in names if name in self.given}

    def across(self) -> np.ndarray | bool:
        """Return which joints have a part of the law that also acts normal to them [N - 1]."""
        without = {name: one for part in PARTS for name, one in part.without.items()}
        has = (self.given[name] != without[name] for name in ACROSS if name in self.given)
        return reduce(np.logical_or, has, False)


def strength_of(laws: Sequence[JointLaw], which: np.ndarray) -> Strength:
    """Return the strength of joints; which : index in `laws` of each joint's law, int array [n].

    If some joints slip, one without friction and cohesion gets unlimited cohesion; for other parts
    of the law `PARTS` has the values of joints without them.
    """
    angles, given, residual = ([getattr(law, key) for law in laws] for key in SLIP)
    never = [angle is None and own is None for angle, own in zip(angles, given, strict=True)]
    found: dict[str, Sequence[float]] = {}
    if not all(never):
        whole = [UNLIMITED if n else own or 0.0 for n, own in zip(never, given, strict=True)]
        left = [w if own is None else own for w, own in zip(whole, residual, strict=True)]
        if any(angle is not None for angle in angles):
            found["friction"] = [tangent(one) for one in angles]
        if any(never) or any(own is not None for own in given):
            found["cohesion"] = whole
        if any(own is not None for own in residual):
            found["residual_cohesion"] = left
    for part in PARTS:
        if any(map(part.of, laws)):
            values = zip(*map(part.parameters, laws), strict=True)
            found |= dict(zip(part.without, values, strict=True))
    return Strength({name: np.array(values, dtype=float)[which] for name, values in found.items()})


@dataclass(frozen=True, kw_only=True)
class Properties(JointedRock, Strength):
    """Properties of a pillar for engines and exact solutions, with the strength of its joints. If
    blocks or joints differ, scalar attributes are means.

    contact_y : float array [N + 1], start of each block and end of the last one, m.
    stiffness, shear_stiffness : float arrays [N - 1], K'_n, K'_s between rigid blocks, Pa/m.
    own_stiffness, own_shear_stiffness : float arrays [N - 1], the joints' own K_n and K_s, (6)
        inverted, Pa/m; None without intact_modulus; infinite where the rock alone is too soft.
    joint_time_constant : float array [N - 1], eta of each joint, s; None without any dashpot.
    own_time_constant : the same without the rock's part; between segments from both halves.
    ordinary_time_constant : float array [N - 1], eta of each joint without soft layers, s.
    rock_time_constant : float array [N - 1], eta of `rock_between`, s.
    tension : bool array [N - 1], whether a joint carries tension.
    soft : int array, indices of the joints that [[soft_layers]] changes.
    weld : bool array [N - 1], whether a contact is no joint, between blocks of intact segments.
    regular : float array [N - 1], K'_n of the homogenised bar at each joint, Pa/m.
    half_joint : float array [2, N], half an ordinary joint's compliance in the homogenised bar of
        each block, normal and shear, m/Pa; less than all of the bar's.
    rock_between : float array [N - 1], compliance of intact rock from centre to centre, m/Pa.
    parts : the rock of each segment by itself; empty if all blocks are equal, and all joints except
        soft layers.
    segment : int array [N], index of each block's rock in `each`.
    end_stress : stress that closes joints at the start and the end at rest, Pa.
    """

    contact_y: np.ndarray
    stiffness: np.ndarray
    shear_stiffness: np.ndarray
    own_stiffness: np.ndarray | None
    own_shear_stiffness: np.ndarray | None
    joint_time_constant: np.ndarray | None
    own_time_constant: np.ndarray | None
    ordinary_time_constant: np.ndarray
    rock_time_constant: np.ndarray
    tension: np.ndarray
    soft: np.ndarray
    weld: np.ndarray
    regular: np.ndarray
    half_joint: np.ndarray
    rock_between: np.ndarray
    segment: np.ndarray
    parts: tuple[JointedRock, ...]
    end_stress: tuple[float, float]

    @property
    def is_uniform(self) -> bool:
        """Whether all blocks are equal, and all joints except soft layers."""
        return not self.parts

    @property
    def each(self) -> tuple[JointedRock, ...]:
        """The rock of each segment; these properties alone if there is one rock."""
        return self.parts or (self,)

    @property
    def at_start(self) -> JointedRock:
        """The rock at the start."""
        return replace(self.each[0], prestress=self.end_stress[0])

    @property
    def at_end(self) -> JointedRock:
        """The rock at the end."""
        return replace(self.each[-1], prestress=self.end_stress[1])

    @property
    def joint_y(self) -> np.ndarray:
        """Places of the joints, m [N - 1]."""
        return self.contact_y[1:-1]

    @property
    def centre_y(self) -> np.ndarray:
        """Centres of the blocks, m [N]."""
        y = self.contact_y
        return y[1:] - self.spacing / 2 if self.is_uniform else (y[1:] + y[:-1]) / 2

    def travel_time(self, y: float) -> float:
        """Return the travel time along the homogenised bar from the start to y (m), s."""
        slowness = np.array([1 / one.at_rest.bar_speed for one in self.each])[self.segment]
        arrivals = np.append(0.0, np.cumsum(slowness * np.diff(self.contact_y)))
        return float(np.interp(y, self.contact_y, arrivals))

    @property
    def masses(self) -> np.ndarray | None:
        """Mass of each block, kg [N]; None if all have `block_mass`."""
        if self.is_uniform:
            return None
        density = np.array([one.density for one in self.parts])[self.segment]
        return density * self.area * np.diff(self.contact_y)

    @property
    def resolved(self) -> np.ndarray:
        """Indices of the joints that the jointed rock resolves: all except welds of intact rock."""
        return np.flatnonzero(~self.weld)

    @property
    def regular_stiffness(self) -> float:
        """K'_n of an ordinary joint, Pa/m; the least where they differ."""
        return float(np.min(self.regular))

    @property
    def rock_compliance(self) -> np.ndarray | None:
        """The rock's part of the compliance between rigid blocks [N - 1], m/Pa, at most all but
        1e-9 of it; None if no joint stiffens."""
        if self.maximum_closure is None:
            return None
        return np.minimum(self.rock_between, (1 - 1e-9) / self.stiffness)

    @property
    def excess_compliance(self) -> np.ndarray:
        """Compliance of each joint beyond the ordinary one in the homogenised bar [N - 1], m/Pa.
        1/K = 1/K'_n - 1/K'_n(regular); exactly zero for a joint as stiff as the others."""
        return _beyond(self.stiffness, self.regular)

    @property
    def excess_shear_compliance(self) -> np.ndarray:
        """The same in shear, m/Pa [N - 1]."""
        return _beyond(self.shear_stiffness, self.regular_shear_stiffness)

    @property
    def excess_time_constant(self) -> np.ndarray:
        """Time constant of the excess compliance, s [N - 1], such that excess and bar together have
        the joint's dashpot in slow motion; never negative."""
        if self.joint_time_constant is None:
            return np.zeros_like(self.stiffness)
        viscous = self.joint_time_constant / self.stiffness
        viscous -= self.ordinary_time_constant / self.regular
        excess = self.excess_compliance
        usual = self.joint_time_constant
        return np.maximum(np.divide(viscous, excess, out=usual.copy(), where=excess != 0), 0.0)

    @property
    def damps_alone(self) -> np.ndarray:
        """Whether a joint as stiff as the others has a different dashpot, bool array [N - 1]. The
        homogenised bar cannot represent such a dashpot."""
        if self.joint_time_constant is None:
            return np.zeros_like(self.tension)
        usual = self.ordinary_time_constant
        same = np.isclose(self.joint_time_constant, usual, rtol=1e-9, atol=0)
        return ~same & (self.excess_compliance == 0)


def _beyond(stiffness: np.ndarray, regular: float | np.ndarray) -> np.ndarray:
    same = np.isclose(stiffness, regular, rtol=1e-9, atol=0)
    return np.where(same, 0.0, 1 / stiffness - 1 / regular)
