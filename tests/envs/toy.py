"""A task that is declared and registered outside the package, as a user would."""

import numpy as np

import elastica_gym
from elastica_gym.bodies import snake
from elastica_gym.envs import Task, goal_conditioned
from elastica_gym.envs.starts import draw_start
from elastica_gym.scripted import register_script
from elastica_gym.scripted.gaits import snake_crawl

TOY, TOY_GOAL = "tests/SnakeAway-v0", "tests/SnakeAwayGoal-v0"


def draw_start_place(rng, situation):
    return np.array([*situation.pose.centre[0, [0, 2]], rng.uniform(0.1, 0.2)])


def see_speed(situation):
    return situation.goal[:, 2:]


def from_start(centre, goal):
    return np.hypot(centre[:, 0] - goal[:, 0], centre[:, 2] - goal[:, 1])


def distance(situation):
    return from_start(situation.pose.centre, situation.goal)


def away(situation):
    return (distance(situation) - from_start(situation.before.centre, situation.goal)) / situation.body.senses.length


def lost(situation):
    return distance(situation) > 10.0


def is_away(situation):
    return distance(situation) > situation.goal[:, 2]


def no_target(goal):
    return None


def crawl_on(env):
    return snake_crawl(env, np.zeros(env.num_envs))


def draw_goal_nearby(rng, situation):
    place = situation.pose.head[0, [0, 2]] + rng.uniform(-0.1, 0.1, 2)
    return np.array([*place, np.hypot(*(place - situation.pose.head[0, [0, 2]]))])


AWAY = Task(
    name="SnakeAway",
    make_body=snake,
    duration=5.0,
    starts={"bent": draw_start},
    goal_size=3,
    draw_goal=draw_start_place,
    goal_names=("distance_to_make",),
    goal_bounds=((0.0, 1.0),),
    see_goal=see_speed,
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
elastica_gym.register(TOY_GOAL, goal_conditioned(AWAY, draw_goal=draw_goal_nearby, tolerance=0.05))
