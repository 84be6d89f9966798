"""Damping of the motion: Rayleigh's coefficients, and the resulting dashpots."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.schema.damping import Damping, Rayleigh


def rayleigh(**keys):
    return {"damping": {"rayleigh": keys}}


@given(
    low=st.floats(0.1, 1e3),
    factor=st.floats(1.5, 100.0),
    first=st.floats(1e-3, 0.5),
    share=st.floats(0.01, 0.99),
)
def test_rayleigh_has_the_ratios_that_were_asked_for(low, factor, first, share):
    """zeta = alpha / (2 omega) + beta omega / 2 at both; positive between ratios 1/r and r."""
    second = first * (1 / factor + share * (factor - 1 / factor))
    law = Rayleigh(frequencies=[low, factor * low], ratios=[first, second])
    alpha, beta = law.coefficients
    for f, ratio in zip(law.frequencies, law.ratios, strict=True):
        omega = 2 * np.pi * f
        assert alpha / (2 * omega) + beta * omega / 2 == pytest.approx(ratio, rel=1e-9)


def test_ratios_as_the_frequencies_damp_by_stiffness_alone(scene_with):
    """The round-off of alpha = 0 is neither refused nor computed with."""
    p = calibrate(scene_with(**rayleigh(frequencies=[10.0, 70.0], ratios=[0.013, 0.091])))
    assert p.mass_damping is None
    assert p.time_constant == pytest.approx(2 * 0.013 / (20 * np.pi), rel=1e-12)


def test_ratios_against_the_frequencies_damp_by_mass_alone(scene_with):
    p = calibrate(scene_with(**rayleigh(frequencies=[10.0, 70.0], ratios=[0.091, 0.013])))
    assert p.mass_damping == pytest.approx(0.091 * 40 * np.pi, rel=1e-12)
    assert p.time_constant is None and p.joint_time_constant is None


def test_beta_is_the_time_constant_of_every_joint(scene_with):
    layers = [{"y": 20.0, "spacing_stiffness": 4e8}]
    changes = rayleigh(frequencies=[10.0, 100.0], ratios=[0.02, 0.02])
    p = calibrate(scene_with(soft_layers=layers, **changes))
    alpha, beta = Rayleigh(**changes["damping"]["rayleigh"]).coefficients
    assert p.mass_damping == alpha and p.time_constant == beta
    assert (p.joint_time_constant == beta).all()


def test_damping_of_zero_is_none(scene_with):
    p = calibrate(scene_with(damping={"mass_proportional": 0.0, "local": 0.0}))
    assert p.mass_damping is None and p.local_damping is None
    assert Damping().alpha is None


def test_damping_that_is_given(scene_with):
    p = calibrate(scene_with(damping={"mass_proportional": 5.0, "local": 0.8}))
    assert p.mass_damping == 5.0 and p.local_damping == 0.8
    assert p.time_constant is None
