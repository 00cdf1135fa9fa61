"""Invalid arguments raise at construction, with name, value and bound."""

import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from elastica_gym.engine import Rod, Wave, build_model, stable_time_step
from elastica_gym.engine.rod import require_stable
from elastica_gym.engine.surroundings import Plane

from .scenes import WAVE, snake

MATERIAL = dict(density=1000.0, youngs_modulus=1e6, shear_modulus=4e5)
STRAIGHT = dict(start=(0, 0, 0), direction=(0, 0, 1), normal=(0, 1, 0), length=1.0, radius=0.01, **MATERIAL)

not_positive = st.floats(max_value=0.0) | st.sampled_from([np.nan, np.inf])
negative = st.floats(max_value=-1e-300) | st.sampled_from([np.nan, np.inf])


def refused(make, name, value=None):
    """Check that ``make`` raises a ValueError that names the argument and its value."""
    with pytest.raises(ValueError, match=re.escape(name)) as error:
        make()
    if value is not None:
        assert str(value) in str(error.value)


@given(st.sampled_from(["length", "radius", "density", "youngs_modulus", "shear_modulus"]), not_positive)
def test_rod_needs_positive_numbers(name, value):
    refused(lambda: Rod.straight(4, **{**STRAIGHT, name: value}), name, None if name == "radius" else value)


@given(st.sampled_from(["damping_rate", "viscosity", "torque_viscosity"]), negative)
def test_damping_is_not_negative(name, value):
    refused(lambda: Rod.straight(4, **{**STRAIGHT, name: value}), name, value)


@given(st.integers(max_value=1))
def test_rod_needs_two_elements(n):
    refused(lambda: Rod.straight(n, **STRAIGHT), "n_elements", n)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("direction", (0, 0, 0)),
        ("normal", (0, 0, 0)),
        ("normal", (0, 0, 2)),
        ("start", (0, 0)),
        ("start", (0, np.nan, 0)),
    ],
)
def test_rod_needs_a_position_and_directions(name, value):
    refused(lambda: Rod.straight(4, **{**STRAIGHT, name: value}), name)


def test_rod_checks_shapes_and_directors():
    rod = snake(4)
    given_ = dict(position=rod.position, directors=rod.directors, radius=rod.radius, **MATERIAL)
    for name, value in (
        ("position", np.zeros((3, 2))),
        ("position", np.zeros((2, 5))),
        ("element length", np.zeros((3, 5))),
        ("directors", np.zeros((3, 3, 4))),
        ("directors", -rod.directors),
        ("directors", rod.directors[:, :, :3]),
        ("rest_kappa", np.zeros((3, 4))),
        ("rest_sigma", np.full((3, 4), np.nan)),
        ("radius", np.full(3, 0.1)),
        ("radius", np.array([0.1, 0.1, -0.1, 0.1])),
    ):
        argument = "position" if name == "element length" else name
        refused(lambda argument=argument, value=value: Rod(**{**given_, argument: value}), name)


@given(st.sampled_from(["stiffness", "damping", "surface_tolerance", "slip_tolerance"]), negative)
def test_plane_needs_valid_numbers(name, value):
    refused(lambda: Plane(**{name: value}), name, value)


@given(st.sampled_from(["kinetic_friction", "static_friction"]), st.integers(0, 2), negative)
def test_friction_is_not_negative(name, place, value):
    coefficients = [0.1, 0.1, 0.1]
    coefficients[place] = value
    refused(lambda: Plane(**{name: tuple(coefficients)}), name, value)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("normal", (0, 0, 0)),
        ("normal", (0, np.nan, 0)),
        ("origin", (0, np.inf, 0)),
        ("origin", (0, 0)),
        ("kinetic_friction", (0.1, 0.1)),
        ("slip_tolerance", 0.0),
    ],
)
def test_plane_needs_a_position(name, value):
    refused(lambda: Plane(**{name: value}), name)


@given(st.sampled_from(["period", "ramp_time"]), negative)
def test_wave_times(name, value):
    given_ = dict(coefficients=(1.0, 1.0, 1.0, 1.0), period=1.0, wave_number=1.0)
    refused(lambda: Wave(**{**given_, name: value}), name, value)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("coefficients", (1.0, 1.0, 1.0)),
        ("coefficients", (1.0, 1.0, 1.0, np.nan)),
        ("wave_number", np.nan),
        ("phase", np.inf),
        ("axis", (0, 1)),
        ("axis", (0, np.nan, 1)),
        ("period", 0.0),
    ],
)
def test_wave_needs_finite_numbers(name, value):
    given_ = dict(coefficients=(1.0, 1.0, 1.0, 1.0), period=1.0, wave_number=1.0)
    refused(lambda: Wave(**{**given_, name: value}), name)


def test_model_needs_rods_and_valid_loads():
    rod = snake(4)
    refused(lambda: build_model([]), "rods")
    refused(lambda: build_model([rod], gravity=(0, 1)), "gravity")
    refused(lambda: build_model([rod], gravity=(0, np.nan, 0)), "gravity")
    refused(lambda: build_model([rod], activation_time=-1.0), "activation_time", -1.0)
    refused(
        lambda: build_model([rod], waves=[Wave(coefficients=WAVE.coefficients, period=1, wave_number=1, rod=1)]),
        "rod 1",
    )


def test_time_step_above_the_stable_one():
    rods = [snake(10), snake(50)]
    bound = stable_time_step(rods[1])
    require_stable(rods, 0.99 * bound)
    for step in (1.01 * bound, np.nan):
        with pytest.raises(ValueError, match="time step") as error:
            require_stable(rods, step)
        assert f"{bound:.4g}" in str(error.value) and f"{step:g}" in str(error.value)
