"""What stands by thrust alone: a semicircular arch of equal voussoirs without tension (Milankovitch).

It stands from a ratio of thickness to the radius of its centre line on, 0.1075 with continuous radial
joints that do not slide. With eleven voussoirs that have chords for faces a linear programme finds
0.1046: forces at both ends of every joint, pushing, in balance with the weights (lower bound
theorem; friction of 80 degrees never decides). Points at a lever of the half thickness from the
centre line divide it by the lever, since they are all that the thrust line can reach.
"""

import numpy as np
import pytest
from scipy.optimize import brentq, linprog

import jointwave as jw
from cases.errors import SceneError
from cases.material.contact_points import lever
from cases.warnings import warnings

RADIUS, VOUSSOIRS, FRICTION = 10.0, 11, 80.0  # m, degrees
ANGLES = np.pi * np.arange(VOUSSOIRS + 1) / VOUSSOIRS
LEAST = 0.1046
