"""TentacleReach: bring the tip to a target within 3 s; a task for a body defined outside the package.

A tentacle in water, clamped at its base, and a target in the water in front of it.

Version history
---------------
v0: the first.
"""

from typing import NamedTuple

import numpy as np

import elastica_gym
from elastica_gym.bodies.observation import Block
from elastica_gym.envs import Task
from elastica_gym.envs.task import effort, in_heading_frame
from elastica_gym.scripted import register_script

from .tentacle import LENGTH, tentacle

TENTACLE = "tests/TentacleReach-v0"
NEAR = 0.08
"""Distance from the target that counts as success, in body lengths"""


class Goal(NamedTuple):
    """A target."""

    x: np.ndarray
    """Position [m]"""
    y: np.ndarray
    """The same [m]"""
    z: np.ndarray
    """The same [m]"""
    way: np.ndarray
    """Initial distance of the tip [m]"""


def drift(rng, body, state, i):
    """Write the tentacle at rest with a small sideways velocity that grows towards the tip."""
    for field, resting in zip(state, body.rest, strict=True):
        field[i] = resting[0]
    nodes = body.nodes(0)
    state.v[i, 1:, nodes] = rng.normal(0.0, 0.05, (2, 1)) * np.linspace(0.0, 1.0, body.rods[0].n_elements + 1)


def sample_goal(rng, situation):
    """Return the tip of the tentacle on a random arc, bent by 0.5 to 1.5 rad in any direction."""
    angle, side = rng.uniform(0.5, 1.5), rng.uniform(-np.pi, np.pi)
    along, across = np.sin(angle) / angle * LENGTH, (1.0 - np.cos(angle)) / angle * LENGTH
    place = np.array([along, 0.5 + across * np.cos(side), across * np.sin(side)])
    return Goal(*place, np.linalg.norm(place - situation.pose.head[0]))


def gap(goal, tip):
    x, y, z = goal.x - tip[:, 0], goal.y - tip[:, 1], goal.z - tip[:, 2]
    return np.sqrt(x * x + y * y + z * z)


def observe_goal(situation):
    goal, tip = situation.goal, situation.pose.head
    forward, right = in_heading_frame(situation, goal.x - tip[:, 0], goal.z - tip[:, 2])
    return np.stack([forward, goal.y - tip[:, 1], right], axis=1) / LENGTH


def approach(situation):
    """Return the decrease of the distance to the target in this step, in body lengths, (B,)."""
    return (gap(situation.goal, situation.before.head) - gap(situation.goal, situation.pose.head)) / LENGTH


def distance(situation):
    """Return the decrease of the distance to the target since the start [m], (B,)."""
    return situation.goal.way - gap(situation.goal, situation.pose.head)


def succeeds(situation):
    """Return whether the tip is at the target, (B,) bool."""
    return gap(situation.goal, situation.pose.head) <= NEAR * LENGTH


def target(goal):
    return np.stack([goal.x, goal.y, goal.z], axis=1)


def bend_towards(env):
    """Return the actions that bend the tentacle increasingly towards the target, (B, 21)."""
    goal, tip, muscles = env.situation().goal, env.pose.head, env.body.muscles
    actions = env.levels.copy()
    for direction, off in (("normal", goal.z - tip[:, 2]), ("binormal", tip[:, 1] - goal.y)):
        actions[:, muscles.columns(direction, "whole")] += GAIN * off[:, None] / LENGTH
    return np.clip(actions, -1.0, 1.0)


GAIN = 0.5
"""Activation added to the reached one, per distance in body lengths"""

REACH = Task(
    name="TentacleReach",
    description=__doc__,
    make_body=tentacle,
    duration=3.0,
    initial_states={"drifting": drift},
    goal_type=Goal,
    sample_goal=sample_goal,
    goal_blocks=(
        Block("goal", ("forward", "up", "right"), -4.0, 4.0, "body length", "way from the tip to the target"),
    ),
    observe_goal=observe_goal,
    reward_terms={"approach": approach, "effort": effort},
    reward_weights={"approach": 10.0, "effort": 0.1, "diverged": -10.0},
    distance=distance,
    succeeds=succeeds,
    ends_on_success=True,
    target=target,
)

elastica_gym.register(TENTACLE, REACH)
register_script(REACH.name, bend_towards)
