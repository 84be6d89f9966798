"""The properties of a scene: stiffness, damping and strength of joints, inertia of blocks."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, sqrt
from typing import Any

import numpy as np

from jointwave.cases.material.elastic import joint_stiffness
from jointwave.cases.material.strength import Strength

#: Times that intact rock may be stiffer than rock with joints where it joins an end block to a
#: wall: stiffer yet it would but shorten the step, of a half block that is rigid beside the joints.
RIGID = 100.0


@dataclass(frozen=True, kw_only=True)
class Properties(Strength):
    """The properties of a scene shared by both engines and all exact solutions, with the
    strength of its joints; where blocks or joints differ, one number for all of them is a mean.

    Attributes
    ----------
    block_count : number of blocks N.
    spacing, side, area : block thickness (m), side (m) and area (m2) of the section.
    density, block_mass : kg/m3, kg.
    inertia_across, inertia_along : of a block about x or z, and about y, kg m2.
    modulus, poisson : Young's modulus (Pa) and Poisson's ratio of the homogenised rock mass.
    shear_modulus : G of the homogenised rock mass, Pa.
    intact_modulus : Pa, or None where the scene does not give it.
    bar_speed, shear_speed : sqrt(modulus / density), sqrt(shear_modulus / density), m/s.
    impedance, shear_impedance : density times these speeds, Pa s/m, also of the quiet ends.
    time_constant : Kelvin-Voigt eta of rock and ordinary joints, s; None without dashpots.
    mass_damping : alpha of a force -alpha m v on every block, 1/s; None without.
    local_damping : Cundall's factor, 0 to 1; None without.
    contact_y : float array [N + 1], start of each block and end of the last one, m.
    stiffness, shear_stiffness : float arrays [N - 1], K'_n, K'_s between rigid blocks, Pa/m.
    own_stiffness, own_shear_stiffness : float arrays [N - 1], the joints' own K_n and K_s, Pa/m;
        None without intact_modulus; K_s infinite where intact rock alone is too soft in shear.
    joint_time_constant : float array [N - 1], eta of each joint, s; None without any dashpot.
    own_time_constant : the same of each joint by itself; between segments that of its halves.
    tension : bool array [N - 1], whether a joint carries tension.
    soft : int array, indices of the joints that [[soft_layers]] changes.
    weld : bool array [N - 1], whether a contact is no joint, between blocks of intact segments.
    regular : K'_n that the homogenised bar has at each joint, Pa/m: a number, or [N - 1].
    rock_between : compliance of intact rock from centre to centre, m/Pa: a number, or [N - 1].
    parts : the properties of each segment as if it were alone; none where all blocks are equal, and
        all joints except the soft layers.
    segment : int array [N], which of `each` the blocks belong to.
    ordinary_time_constant : float array [N - 1], eta of each joint without soft layers, s; None
        where that is time_constant.
    """

    block_count: int
    spacing: float
    side: float
    area: float
    density: float
    block_mass: float
    inertia_across: float
    inertia_along: float
    modulus: float
    poisson: float
    shear_modulus: float
    intact_modulus: float | None
    bar_speed: float
    shear_speed: float
    impedance: float
    shear_impedance: float
    time_constant: float | None
    mass_damping: float | None
    local_damping: float | None
    contact_y: np.ndarray
    stiffness: np.ndarray
    shear_stiffness: np.ndarray
    own_stiffness: np.ndarray | None
    own_shear_stiffness: np.ndarray | None
    joint_time_constant: np.ndarray | None
    own_time_constant: np.ndarray | None
    tension: np.ndarray
    soft: np.ndarray
    weld: np.ndarray
    regular: float | np.ndarray
    rock_between: float | np.ndarray
    segment: np.ndarray
    parts: tuple[Properties, ...] = ()
    ordinary_time_constant: np.ndarray | None = None

    @property
    def is_uniform(self) -> bool:
        """Whether all blocks are equal, and all joints except the soft layers."""
        return not self.parts

    @property
    def each(self) -> tuple[Properties, ...]:
        """The properties of each segment; only these if there is one rock."""
        return self.parts or (self,)

    @property
    def at_start(self) -> Properties:
        """Those of the rock at the start; of one rock these."""
        return self.each[0]

    @property
    def at_end(self) -> Properties:
        """Those of the rock at the end; of one rock these."""
        return self.each[-1]

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
        slowness = np.array([1 / one.bar_speed for one in self.each])[self.segment]
        arrivals = np.append(0.0, np.cumsum(slowness * np.diff(self.contact_y)))
        return float(np.interp(y, self.contact_y, arrivals))

    @property
    def masses(self) -> np.ndarray | None:
        """Mass of each block, kg [N]; None where all have `block_mass`."""
        if self.is_uniform:
            return None
        density = np.array([one.density for one in self.parts])[self.segment]
        return density * self.area * np.diff(self.contact_y)

    @property
    def resolved(self) -> np.ndarray:
        """The joints of the jointed rock, int array: all, but for welds of intact rock."""
        return np.flatnonzero(~self.weld)

    @property
    def regular_stiffness(self) -> float:
        """K'_n of an ordinary joint, Pa/m; the least where they differ."""
        return float(np.min(self.regular))

    @property
    def regular_shear_stiffness(self) -> float:
        """K'_s of an ordinary joint, Pa/m."""
        return self.shear_modulus / self.spacing

    @property
    def regular_own_stiffness(self) -> float:
        """K_n of an ordinary joint itself, Pa/m, by (4); needs intact_modulus."""
        assert self.intact_modulus is not None
        return joint_stiffness(self.modulus, self.intact_modulus, self.spacing)

    @property
    def regular_own_shear_stiffness(self) -> float:
        """K_s of an ordinary joint itself, Pa/m; needs intact_modulus."""
        assert self.own_shear_stiffness is not None
        ordinary = np.setdiff1d(np.arange(self.block_count - 1), self.soft)
        return float(self.own_shear_stiffness[ordinary[0] if ordinary.size else 0])

    @property
    def wall_stiffness(self) -> float:
        """Of the half block of rock between the centre of an end block and a wall, Pa/m: intact
        rock, for no joint is there; a block and its joint where no more is known."""
        return _half_block(self.regular_stiffness, self.intact_modulus, self.spacing)

    @property
    def wall_shear_stiffness(self) -> float:
        """The same in shear, Pa/m."""
        whole, rock = self.regular_shear_stiffness, None
        if self.own_shear_stiffness is not None:  # what is left of the compliance without the joint
            left = 1 / whole - 1 / self.regular_own_shear_stiffness
            rock = self.spacing / left if left > 0 else inf
        return _half_block(whole, rock, self.spacing)

    @property
    def rock_compliance(self) -> np.ndarray | None:
        """What rock has of the compliance between rigid blocks [N - 1], m/Pa, at most all but a
        billionth of it; None where no joint stiffens."""
        if self.maximum_closure is None:
            return None
        return np.minimum(self.rock_between, (1 - 1e-9) / self.stiffness)

    @property
    def excess_compliance(self) -> np.ndarray:
        """What each joint adds to the homogenised bar, which holds an ordinary one there, m/Pa.

        1/K = 1/K'_n - 1/K'_n(regular) [N - 1]; exactly zero for a joint as stiff as the others.
        """
        same = np.isclose(self.stiffness, self.regular, rtol=1e-9, atol=0)
        return np.where(same, 0.0, 1 / self.stiffness - 1 / self.regular)

    @property
    def damps_alone(self) -> np.ndarray:
        """Whether a joint as stiff as the others has a dashpot of its own, bool array [N - 1].

        The homogenised bar has no place for such a dashpot.
        """
        if self.joint_time_constant is None:
            return np.zeros_like(self.tension)
        usual = self.ordinary_time_constant
        differs = self.joint_time_constant != (
            (self.time_constant or 0.0) if usual is None else usual
        )
        return differs & (self.excess_compliance == 0)


def of_bar(
    density: float, side: float, spacing: float, modulus: float, shear_modulus: float
) -> dict[str, Any]:
    """Return what follows for `Properties` from these of them."""
    area, speed, shear_speed = side**2, sqrt(modulus / density), sqrt(shear_modulus / density)
    mass = density * area * spacing
    return {
        **{"density": density, "side": side, "spacing": spacing, "area": area, "block_mass": mass},
        "inertia_across": mass * (side**2 + spacing**2) / 12,
        "inertia_along": mass * side**2 / 6,
        **{"modulus": modulus, "bar_speed": speed, "impedance": density * speed},
        "shear_modulus": shear_modulus,
        **{"shear_speed": shear_speed, "shear_impedance": density * shear_speed},
    }


def _half_block(whole: float, rock: float | None, spacing: float) -> float:
    """Return the stiffness of half a block of rock of this modulus (Pa), from that of a block with
    its joint, both Pa/m; None: rock that is not known apart."""
    if rock is None:
        return 2 * whole
    return 2 * min(rock / spacing, RIGID * whole)
