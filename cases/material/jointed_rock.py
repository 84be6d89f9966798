"""Rock with equal joints as a homogenised bar and as rigid blocks: Guo & Li (2002), (4) to (7)."""

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from math import inf, sqrt
from typing import Any

import numpy as np

from jointwave.cases.material.rock import (
    equivalent_modulus,
    joint_stiffness,
    modulus_from_speeds,
    shear_modulus,
)
from jointwave.cases.schema.scene import Scene
from jointwave.cases.schema.tables import Rock

#: Most ratio of intact to jointed stiffness of the half block at a wall: a stiffer one would only
#: shorten the time step, as it is rigid compared with the joints already.
RIGID = 100.0


@dataclass(frozen=True, kw_only=True)
class JointedRock:
    """A pillar of one rock with equal joints.

    block_count : number of blocks N.
    spacing, side : block thickness and side of the square section, m.
    density : kg/m3.
    modulus, poisson, shear_modulus : Young's modulus (Pa), Poisson's ratio and G (Pa) of the
        homogenised rock mass.
    intact_modulus, intact_shear_modulus : of the blocks, Pa; None if the scene does not give it.
    time_constant : Kelvin-Voigt eta of rock and ordinary joints, s; None without dashpots.
    mass_damping : alpha of a force -alpha m v on every block, 1/s; None without.
    local_damping : Cundall's factor, 0 to 1; None without.
    closes : d_m of ordinary joints, m; None if they do not stiffen. prestress : Pa.
    """

    block_count: int
    spacing: float
    side: float
    density: float
    modulus: float
    poisson: float
    shear_modulus: float
    intact_modulus: float | None
    intact_shear_modulus: float | None
    time_constant: float | None
    mass_damping: float | None
    local_damping: float | None
    closes: float | None
    prestress: float

    @property
    def area(self) -> float:
        """Area of the section, m2."""
        return self.side**2

    @property
    def block_mass(self) -> float:
        """Mass of a block, kg."""
        return self.density * self.area * self.spacing

    @property
    def inertia_across(self) -> float:
        """Moment of inertia of a block about x or z, kg m2."""
        return self.block_mass * (self.side**2 + self.spacing**2) / 12

    @property
    def inertia_along(self) -> float:
        """Moment of inertia of a block about y, kg m2."""
        return self.block_mass * self.side**2 / 6

    @property
    def bar_speed(self) -> float:
        """sqrt(E / rho), m/s."""
        return sqrt(self.modulus / self.density)

    @property
    def shear_speed(self) -> float:
        """sqrt(G / rho), m/s."""
        return sqrt(self.shear_modulus / self.density)

    @property
    def impedance(self) -> float:
        """Impedance of axial waves and quiet ends, Pa s/m."""
        return self.density * self.bar_speed

    @property
    def shear_impedance(self) -> float:
        """The same in shear, Pa s/m."""
        return self.density * self.shear_speed

    @property
    def regular_stiffness(self) -> float:
        """K'_n of an ordinary joint, Pa/m."""
        return self.modulus / self.spacing

    @property
    def regular_shear_stiffness(self) -> float:
        """K'_s of an ordinary joint, Pa/m."""
        return self.shear_modulus / self.spacing

    @property
    def regular_own_stiffness(self) -> float:
        """K_n of an ordinary joint itself, Pa/m, from (4); needs intact_modulus."""
        assert self.intact_modulus is not None
        return joint_stiffness(self.modulus, self.intact_modulus, self.spacing)

    @property
    def regular_own_shear_stiffness(self) -> float:
        """K_s of an ordinary joint itself, Pa/m; infinite if intact rock alone is too soft in
        shear; needs intact_modulus."""
        assert self.intact_shear_modulus is not None
        intact = max(self.intact_shear_modulus, self.shear_modulus)
        return joint_stiffness(self.shear_modulus, intact, self.spacing)

    @property
    def wall_stiffness(self) -> float:
        """Stiffness of the half block between an end block's centre and a wall, Pa/m: intact rock,
        as no joint is there, or the rock mass if the intact modulus is unknown."""
        return self._half_block(self.modulus, self.intact_modulus)

    @property
    def wall_shear_stiffness(self) -> float:
        """The same in shear, Pa/m."""
        return self._half_block(self.shear_modulus, self.intact_shear_modulus)

    @property
    def at_rest(self) -> "JointedRock":
        """This rock for small waves, with joints closed by its prestress."""
        return self.under(self.prestress)

    def under(self, stress: float) -> "JointedRock":
        """Return this rock with its joints closed by a stress (Pa), by `joints.closure`."""
        if self.closes is None or stress <= 0:
            return self
        intact = self.intact_modulus or inf
        own = joint_stiffness(self.modulus, intact, self.spacing)
        own *= (1 + stress / (own * self.closes)) ** 2
        same = {one.name: getattr(self, one.name) for one in fields(JointedRock)}
        return JointedRock(**same | {"modulus": equivalent_modulus(own, intact, self.spacing)})

    def _half_block(self, mass: float, intact: float | None) -> float:
        """Return the stiffness of half a block (Pa/m) from the moduli (Pa) of rock mass and intact
        rock; the latter counts as at least the former."""
        return 2 * min(max(intact or mass, mass), RIGID * mass) / self.spacing


def rock_of(scene: Scene) -> JointedRock:
    """Return the rock of a one-rock scene with its ordinary joints; a given joint stiffness sets
    the modulus, otherwise the modulus sets the stiffness."""
    pillar, rock, joints = scene.pillar, scene.rock, scene.joints
    spacing, intact = pillar.length / pillar.block_count, rock.intact_modulus or inf
    intact_shear = shear_modulus(intact, rock.intact_poisson)
    given = rock.equivalent_poisson
    poisson = rock.intact_poisson if given is None else given
    modulus, poisson = equivalent_constants(rock) or (intact, poisson)
    if joints.normal_stiffness:
        modulus = equivalent_modulus(joints.normal_stiffness, intact, spacing)
    shear = shear_modulus(modulus, poisson)
    if joints.shear_stiffness:
        shear = equivalent_modulus(joints.shear_stiffness, intact_shear, spacing)
    areal_mass = rock.density * pillar.length / pillar.block_count
    eta = joint_time_constant(scene, joints.damping_ratio, areal_mass, modulus / spacing)
    return JointedRock(
        block_count=pillar.block_count,
        spacing=spacing,
        side=pillar.side,
        density=rock.density,
        modulus=modulus,
        poisson=poisson,
        shear_modulus=shear,
        intact_modulus=rock.intact_modulus,
        intact_shear_modulus=intact_shear if rock.intact_modulus else None,
        time_constant=eta or None,
        mass_damping=scene.damping.alpha,
        local_damping=scene.damping.local or None,
        closes=joints.maximum_closure,
        prestress=scene.prestress.normal if scene.prestress else 0.0,
    )


def equivalent_constants(rock: Rock) -> tuple[float, float] | None:
    """Return E (Pa) and Poisson's ratio of the rock mass from [rock]; None if joints set them."""
    if rock.p_speed and rock.s_speed:
        return modulus_from_speeds(rock.p_speed, rock.s_speed, rock.density)
    if rock.equivalent_modulus is None or rock.equivalent_poisson is None:
        return None
    return rock.equivalent_modulus, rock.equivalent_poisson


def joint_time_constant(
    scene: Scene, ratio: float | None, areal_mass: float, stiffness: float
) -> float:
    """Return eta = c / k of a joint, s: Rayleigh's beta, or from a damping ratio, c = 2 zeta sqrt(m
    k) with the mass of a block m (kg/m2) and the stiffness K'_n, k (Pa/m)."""
    if scene.damping.rayleigh is not None:
        return scene.damping.rayleigh.coefficients[1]
    return 2 * (ratio or 0.0) * sqrt(areal_mass / stiffness)


def mean_of(rocks: Sequence[JointedRock]) -> JointedRock:
    """Return the effective rock of a row of rocks for long waves, with mean density and compliance
    (Backus, J. Geophys. Res. 67, 1962) and the largest time constant."""
    if len(rocks) == 1:
        return rocks[0]
    lengths = np.array([one.block_count * one.spacing for one in rocks])
    count = sum(one.block_count for one in rocks)

    def in_series(name: str) -> Any:
        values = [getattr(one, name) for one in rocks]
        return float(lengths.sum() / (lengths / np.array(values)).sum()) if all(values) else None

    moduli = ("modulus", "shear_modulus", "intact_modulus", "intact_shear_modulus")
    return replace(
        rocks[0],
        block_count=count,
        spacing=float(lengths.sum()) / count,
        density=float(np.average([one.density for one in rocks], weights=lengths)),
        poisson=max((one.poisson for one in rocks), key=abs),
        time_constant=max(one.time_constant or 0.0 for one in rocks) or None,
        **{name: in_series(name) for name in moduli},
    )
