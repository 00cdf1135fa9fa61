"""Contact conserves energy: its force is the gradient of the spring's energy, and collisions are elastic."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

import elastica_gym.cosserat as ea
from elastica_gym.engine import Rod, advance, at_rest, build_model, stable_time_step
from elastica_gym.engine.model import Array
from elastica_gym.engine.surroundings import Contact, Cylinder

from .scenes import energy, loop, motion

R, N, SPEED = 1e-3, 10, 0.1
"""Radius [m], elements and approach speed [m/s] of colliding rods"""
MATERIAL = dict(density=1000.0, youngs_modulus=3e5, shear_modulus=1e5)
GAP = 0.02 * R
"""Initial gap [m]"""
LOOK = 4
"""Steps between checks of contact: rods that collide along their length separate after about twenty"""
X, Y, Z = np.eye(3)

ratios = st.sampled_from([0.3, 1.0, 3.0, 8.0])
"""Length over radius of elements"""
places = st.floats(-4.99, 4.99)
"""Contact position on a rod, in elements from its middle"""


class Collision(NamedTuple):
    """Energy before, largest and smallest energy after separation [J], and contact duration in steps."""

    before: float
    most: float
    least: float
    steps: int


def rod_across(ratio: float, place: float, direction: Array, centre: Array) -> Rod:
    """Return a straight rod whose point ``place`` elements from its middle is at ``centre``."""
    length = N * ratio * R
    start, normal = centre - (0.5 + place / N) * length * direction, np.cross(direction, X + 2.0 * Y + Z)
    return Rod.straight(
        N, start=tuple(start), direction=tuple(direction), normal=tuple(normal), length=length, radius=R, **MATERIAL
    )


def collide(rods: list[Rod], velocities: list[Array], law: Contact, dt: float, cylinders=()) -> Collision:
    """Simulate rods and cylinders until they have separated."""
    model = build_model(rods, rod_contact=law, cylinders=cylinders)
    state, control = at_rest(model, rods, cylinders=cylinders)
    for number, velocity in enumerate(velocities):
        motion(model, state, rod=number)[1][:] = velocity

    def total() -> float:
        found = sum(energy(rod, model, state, number=number) for number, rod in enumerate(rods))
        for b in range(len(cylinders)):
            v, w, table = state.body_v[0, b], state.body_w[0, b], model.cylinders
            found += 0.5 * float(table.mass[b] * v @ v + table.inertia[b] @ (w * w))
        return found

    before, touched, apart, after = total(), 0, 0, []
    for _ in range(40_000 // LOOK):
        if apart >= 1000:
            break
        advance(model, state, control, 0, 1, dt, LOOK)
        if state.rod_touch.max() + state.body_touch.max() > 0.0:
            touched, apart, after = touched + LOOK, 0, []
        elif touched:
            apart += LOOK
            after.append(total())
    assert apart >= 1000
    return Collision(before, max(after), min(after), touched)


def law_for(rod: Rod) -> tuple[Contact, float]:
    """Return contact without friction and damping, stable at half the stable step, and a quarter of that step."""
    dt = 0.5 * stable_time_step(rod)
    return Contact(stiffness=rod.nodal_mass[1] * (0.5 / dt) ** 2), 0.25 * dt


def require_kept(found: Collision) -> None:
    assert found.steps > 0
    assert found.most < 1.01 * found.before
    assert found.least > 0.99 * found.before


several = settings(max_examples=15)


@several
@given(ratio=ratios, place=places, other=places, turn=st.floats(0.0, np.pi))
@example(ratio=3.0, place=0.125, other=-0.625, turn=3.140625)
def test_two_rods(ratio, place, other, turn):
    rods = [
        rod_across(ratio, place, X, np.zeros(3)),
        rod_across(ratio, other, np.array([np.cos(turn), 0.0, np.sin(turn)]), (2.0 * R + GAP) * Y),
    ]
    law, dt = law_for(rods[0])
    require_kept(collide(rods, [np.zeros((3, 1)), -SPEED * Y[:, None]], law, dt))


@pytest.mark.parametrize("ratio", [0.3, 1.0, 3.0, 6.0, 8.0])
@pytest.mark.parametrize("places", [(0.0, 0.0), (0.1, 0.1), (0.5, 0.5), (0.0, 0.5)], ids=str)
def test_two_rods_at_and_near_nodes(ratio, places):
    rods = [rod_across(ratio, places[0], X, np.zeros(3)), rod_across(ratio, places[1], Z, (2.0 * R + GAP) * Y)]
    law, dt = law_for(rods[0])
    require_kept(collide(rods, [np.zeros((3, 1)), -SPEED * Y[:, None]], law, dt))


@several
@given(ratio=ratios, place=places, along=st.floats(-1.2, 1.2), turn=st.floats(0.0, np.pi))
def test_rod_and_cylinder(ratio, place, along, turn):
    """Contact between the cylinder's ends and at its caps."""
    rods = [rod_across(ratio, place, X, np.zeros(3))]
    law, dt = law_for(rods[0])
    r, half = 3.0 * R, 4.0 * R
    # at a cap, the rod runs across the axis
    axis = Z if abs(along) > 1.0 else np.array([np.cos(turn), 0.0, np.sin(turn)])
    beyond = max(abs(along) - 1.0, 0.0) * half
    centre = np.array([0.0, np.sqrt((R + r) ** 2 - beyond**2) + GAP, 0.0]) - along * half * axis
    body = Cylinder(
        start=tuple(centre - half * axis),
        direction=tuple(axis),
        normal=(0.0, 1.0, 0.0),
        length=2.0 * half,
        radius=r,
        mass=20.0 * rods[0].nodal_mass[1],
        rods=law,
        ground_stiffness=1.0,
    )
    require_kept(collide(rods, [SPEED * Y[:, None]], law, dt, [body]))


@several
@given(ratio=ratios, place=places)
def test_rod_and_sphere(ratio, place):
    described = rod_across(ratio, place, X, np.zeros(3))
    law, dt = law_for(described)
    rod = ea.CosseratRod.straight_rod(
        N, described.position[:, 0], X, Y, N * ratio * R, R, MATERIAL["density"], youngs_modulus=3e5, shear_modulus=1e5
    )
    ball, made = ea.Sphere((4.0 * R + GAP) * Y, 3.0 * R, 500.0), Simulator()
    for system in (rod, ball):
        made.append(system)
    made.detect_contact_between(rod, ball).using(ea.RodSphereContact, k=law.stiffness, nu=0.0)
    made.finalize()
    rod.velocity_collection[1] = SPEED

    def total() -> float:
        of_rod = (
            rod.compute_translational_energy()
            + rod.compute_rotational_energy()
            + rod.compute_bending_energy()
            + rod.compute_shear_energy()
        )
        # a body's energy is an array of shape (1,), as in PyElastica
        return float(of_rod + np.sum(ball.compute_translational_energy() + ball.compute_rotational_energy()))

    before = total()
    ea.integrate(ea.PositionVerlet(), made, 30_000 * dt, 30_000, progress_bar=False)
    # near its end the rod mostly rotates, and transfers less than a tenth of its speed
    assert ball.velocity_collection[1, 0] > 0.01 * SPEED
    assert total() == pytest.approx(before, rel=0.01)


class Simulator(ea.BaseSystemCollection, ea.Contact):
    pass


@several
@given(ratio=st.sampled_from([1.0, 3.0]), slide=st.floats(-0.5, 0.5))
def test_a_rod_and_itself(ratio, slide):
    """The ends of a loop pass each other, and one swings down onto the other."""
    n = 40
    size = 0.2 * n * ratio * R / 1.4
    rod = loop(n, size=size, gap=2.0 * R + 3.0 * GAP, radius=R, **MATERIAL)
    rod = replace(rod, rest_kappa=rod.curvature)
    law, dt = law_for(rod)
    # faster towards the end
    s = np.linspace(-1.0, 1.0, n + 1)
    swing = SPEED * np.where(s > 0.0, s**2, 0.0) * (slide * X - Y)[:, None]
    require_kept(collide([rod], [swing], law, dt))
