"""Stiffness from wave speeds and back: Guo & Li (2002), (4) to (7), and a scene's numbers.

The rock mass is intact rock in series with its joints. Rigid blocks have no compliance of their
own, so their joints carry all of it: K'_n = E_eq / S.
"""

from dataclasses import dataclass
from math import inf, sqrt

import numpy as np

from cases.scene import Rock, Scene


def modulus_from_speeds(p_speed: float, s_speed: float, density: float) -> tuple[float, float]:
    """Return Young's modulus (Pa) and Poisson's ratio of a medium of these speeds (m/s)."""
    p2, s2 = p_speed**2, s_speed**2
    poisson = (p2 - 2 * s2) / (2 * (p2 - s2))
    return 2 * density * s2 * (1 + poisson), poisson


def speeds_from_modulus(modulus: float, poisson: float, density: float) -> tuple[float, float]:
    """Return the P and S speeds (m/s) of an unbounded medium; inverse of modulus_from_speeds."""
    shear = modulus / (2 * (1 + poisson))
    s2 = shear / density
    return sqrt(s2 * 2 * (1 - poisson) / (1 - 2 * poisson)), sqrt(s2)


def joint_stiffness(equivalent: float, intact: float, spacing: float) -> float:
    """Return the joint's own K_n (Pa/m) that gives the rock mass its modulus, equation (4)."""
    return 1 / (spacing * (1 / equivalent - 1 / intact))


def equivalent_modulus(stiffness: float, intact: float, spacing: float) -> float:
    """Return E_eq (Pa) of intact rock with joints K_n at this spacing; inverse of (4)."""
    return 1 / (1 / intact + 1 / (spacing * stiffness))


def rigid_block_stiffness(stiffness: float, intact: float, spacing: float) -> float:
    """Return K'_n (Pa/m) between rigid blocks for the joint's own K_n, equation (6)."""
    return stiffness / (1 + spacing * stiffness / intact)


def rigid_block_shear_stiffness(normal: float, poisson: float) -> float:
    """Return K'_s (Pa/m) from K'_n, equation (7)."""
    return normal / (2 * (1 + poisson))


@dataclass(frozen=True)
class Properties:
    """The numbers of a scene that both engines and all exact solutions start from.

    Attributes
    ----------
    block_count : number of blocks N.
    spacing, area : block thickness (m), section (m2).
    density, block_mass : kg/m3, kg.
    modulus, poisson : Young's modulus (Pa) and Poisson's ratio of the homogenised rock mass.
    intact_modulus : Pa, or None where the scene does not give it.
    bar_speed : sqrt(modulus / density), m/s.
    impedance : density * bar_speed, Pa s/m, of the homogenised bar and of the quiet ends.
    time_constant : Kelvin-Voigt eta of rock and ordinary joints, s; None without dashpots.
    joint_y : float array [N - 1], m.
    stiffness : float array [N - 1], K'_n between rigid blocks, Pa/m.
    own_stiffness : float array [N - 1], the joints' own K_n, Pa/m; None without intact_modulus.
    joint_time_constant : float array [N - 1], eta of each joint, s; None without any dashpot.
    tension : bool array [N - 1], whether a joint carries tension.
    soft : int array, indices of the joints that [[soft_layers]] changes.
    """

    block_count: int
    spacing: float
    area: float
    density: float
    block_mass: float
    modulus: float
    poisson: float
    intact_modulus: float | None
    bar_speed: float
    impedance: float
    time_constant: float | None
    joint_y: np.ndarray
    stiffness: np.ndarray
    own_stiffness: np.ndarray | None
    joint_time_constant: np.ndarray | None
    tension: np.ndarray
    soft: np.ndarray

    @property
    def regular_stiffness(self) -> float:
        """K'_n of an ordinary joint, Pa/m."""
        return self.modulus / self.spacing

    @property
    def regular_own_stiffness(self) -> float:
        """K_n of an ordinary joint itself, Pa/m, by (4); needs intact_modulus."""
        assert self.intact_modulus is not None
        return joint_stiffness(self.modulus, self.intact_modulus, self.spacing)

    @property
    def excess_compliance(self) -> np.ndarray:
        """What each joint adds to the homogenised bar, which holds an ordinary one there, m/Pa.

        1/K = 1/K'_n - 1/K'_n(regular) [N - 1]; exactly zero for a joint as stiff as the others.
        """
        same = np.isclose(self.stiffness, self.regular_stiffness, rtol=1e-9, atol=0)
        return np.where(same, 0.0, 1 / self.stiffness - 1 / self.regular_stiffness)

    @property
    def damps_alone(self) -> np.ndarray:
        """Whether a joint as stiff as the others has a dashpot of its own, bool array [N - 1].

        The homogenised bar has no place for such a dashpot.
        """
        if self.joint_time_constant is None:
            return np.zeros_like(self.tension)
        differs = self.joint_time_constant != (self.time_constant or 0.0)
        return differs & (self.excess_compliance == 0)


def calibrate(scene: Scene) -> Properties:
    """Return the properties of a scene: every joint's stiffness, damping and tension."""
    pillar, rock, joints = scene.pillar, scene.rock, scene.joints
    spacing, area, count = pillar.length / pillar.block_count, pillar.area, pillar.block_count
    intact = rock.intact_modulus or inf
    modulus, poisson = _rock_mass(rock)
    if joints.normal_stiffness:
        modulus = equivalent_modulus(joints.normal_stiffness, intact, spacing)
    mass = rock.density * area * spacing

    def eta(ratio: float | None, stiffness: float) -> float:
        return 0.0 if ratio is None else 2 * ratio * sqrt(mass / (stiffness * area))

    stiffness = np.full(count - 1, modulus / spacing)
    own = np.full(count - 1, joint_stiffness(modulus, intact, spacing))
    etas = np.full(count - 1, eta(joints.damping_ratio, modulus / spacing))
    tension = np.full(count - 1, joints.tension is not False)
    soft = np.array([round(layer.y / spacing) - 1 for layer in scene.soft_layers], dtype=np.int64)
    damped = joints.damping_ratio is not None
    for j, layer in zip(soft, scene.soft_layers, strict=True):
        given = layer.normal_stiffness or (layer.spacing_stiffness or 0) / spacing
        if given:
            own[j] = given
            stiffness[j] = rigid_block_stiffness(given, intact, spacing)
        ratio = joints.damping_ratio if layer.damping_ratio is None else layer.damping_ratio
        damped = damped or ratio is not None
        etas[j] = eta(ratio, stiffness[j])
        tension[j] = tension[j] if layer.tension is None else layer.tension
    speed = sqrt(modulus / rock.density)
    return Properties(
        block_count=count,
        spacing=spacing,
        area=area,
        density=rock.density,
        block_mass=mass,
        modulus=modulus,
        poisson=poisson,
        intact_modulus=rock.intact_modulus,
        bar_speed=speed,
        impedance=rock.density * speed,
        time_constant=(
            eta(joints.damping_ratio, modulus / spacing)
            if joints.damping_ratio is not None
            else None
        ),
        joint_y=spacing * np.arange(1, count),
        stiffness=stiffness,
        own_stiffness=own if rock.intact_modulus else None,
        joint_time_constant=etas if damped else None,
        tension=tension,
        soft=soft,
    )


def _rock_mass(rock: Rock) -> tuple[float, float]:
    if rock.p_speed and rock.s_speed:
        return modulus_from_speeds(rock.p_speed, rock.s_speed, rock.density)
    assert rock.equivalent_modulus and rock.equivalent_poisson is not None
    return rock.equivalent_modulus, rock.equivalent_poisson
