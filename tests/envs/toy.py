"""A task declared and registered outside the package, as by a user."""

from typing import NamedTuple

import numpy as np

import elastica_gym
from elastica_gym.bodies import snake
from elastica_gym.bodies.observation import single
from elastica_gym.envs import Task, goal_conditioned
from elastica_gym.envs.initial_states import bent
from elastica_gym.envs.tasks import snake_reach
from elastica_gym.scripted import register_script
from elastica_gym.scripted.gaits import snake_crawl

TOY, TOY_GOAL = "tests/SnakeAway-v0", "tests/SnakeAwayGoal-v0"


class Goal(NamedTuple):
    start_x: np.ndarray
    start_z: np.ndarray
    way: np.ndarray


def sample_start_place(rng, situation):
    return Goal(*situation.pose.centre[0, [0, 2]], rng.uniform(0.1, 0.2))


def observe_way(situation):
    return situation.goal.way[:, None]


def from_start(centre, goal):
    return np.hypot(centre[:, 0] - goal.start_x, centre[:, 2] - goal.start_z)


def distance(situation):
    return from_start(situation.pose.centre, situation.goal)


def away(situation):
    """Return the distance gained from the start in this step, in body lengths, (B,)."""
    return (distance(situation) - from_start(situation.before.centre, situation.goal)) / situation.body.sensors.length


def lost(situation):
    return np.hypot(situation.pose.centre[:, 0], situation.pose.centre[:, 2]) > 10.0


def is_away(situation):
    return distance(situation) > situation.goal.way


def no_target(goal):
    return None


def crawl_on(env):
    return snake_crawl(env, np.zeros(env.num_envs))


def sample_goal_nearby(rng, situation):
    place = situation.pose.head[0, [0, 2]] + rng.uniform(-0.1, 0.1, 2)
    return snake_reach.Goal(*place, np.hypot(*(place - situation.pose.head[0, [0, 2]])))


AWAY = Task(
    name="SnakeAway",
    make_body=snake,
    duration=5.0,
    initial_states={"bent": bent},
    goal_type=Goal,
    sample_goal=sample_start_place,
    goal_blocks=(single("distance_to_make", 0.0, 1.0, "m", "distance to make"),),
    observe_goal=observe_way,
    reward_terms={"away": away},
    reward_weights={"away": 10.0, "diverged": -5.0},
    distance=distance,
    succeeds=is_away,
    ends_on_success=False,
    failures={"lost": lost},
    target=no_target,
)

elastica_gym.register(TOY, AWAY)
register_script(AWAY.name, crawl_on)
elastica_gym.register(TOY_GOAL, goal_conditioned(AWAY, sample_goal=sample_goal_nearby, tolerance=0.05))
