"""OctopusFetch by script: the octopus walks to its object, bends an arm around it and carries it home.

It runs `elastica_gym.scripted.octopus_fetch`, whose tables were found by CMA-ES, without access to the environment: it
counts the time, and infers from the goal whether the object is grabbed.
"""

import numpy as np

from elastica_gym.bodies import octopus
from elastica_gym.envs import task_of
from elastica_gym.scripted.octopus_fetch import act, see

CONTROL_DT = 0.05
"""Time between actions [s]"""
LAYOUT = task_of("elastica_gym/OctopusFetch-v1").layout(octopus())

# memory: the file is executed once per episode
steps = 0


def policy(observation: np.ndarray) -> np.ndarray:
    """Return the actions (42,) for an observation (210,) of `elastica_gym.envs.tasks.octopus_fetch`."""
    global steps
    time = steps * CONTROL_DT
    steps += 1
    return act(see(observation[None]), np.array([time]), np.array([has_grabbed(observation)]))[0]


def has_grabbed(observation: np.ndarray) -> bool:
    """Return whether the direction to go differs from the direction to the object."""
    # forward and right, without up
    way = observation[LAYOUT["object/0/position"]][[0, 2]]
    to_object = way / max(float(np.linalg.norm(way)), 1e-9)
    return bool(np.abs(observation[LAYOUT["goal"]] - to_object).max() > 1e-3)
