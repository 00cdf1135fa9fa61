"""OctopusFetch by script: the octopus walks to its object, bends an arm around it and carries it home.

It is `elastica_gym.envs.octopus_script`, whose tables CMA-ES has found, and adds what that is told by the
environment: it counts the time, remembers how far the head has been from home, and sees whether the object is grabbed
by where the goal is.
"""

import numpy as np

from elastica_gym.envs.octopus_script import act, see

CONTROL_DT = 0.05
"""From one action to the next [s]"""
THING, GOAL, HOME = [148, 150], [206, 207], [208, 209]
"""Where an observation has, forward and right: the object, the direction to the goal, and the way home"""

# memory: the file is run afresh for every episode
steps = 0
furthest = 0.0


def policy(observation: np.ndarray) -> np.ndarray:
    """Return the actions (42,) for an observation (210,) of `elastica_gym.envs.octopus_fetch`."""
    global steps, furthest
    time = steps * CONTROL_DT
    steps += 1
    # of a body of 1 m
    furthest = max(furthest, float(np.linalg.norm(observation[HOME])))
    told = time, has_grabbed(observation), furthest
    return act(see(observation[None]), *(np.array([each]) for each in told))[0]


def has_grabbed(observation: np.ndarray) -> bool:
    """Return whether the direction to go is not that to the object."""
    to_object = observation[THING] / max(float(np.linalg.norm(observation[THING])), 1e-9)
    return bool(np.abs(observation[GOAL] - to_object).max() > 1e-3)
