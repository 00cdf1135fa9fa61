"""A policy as a Python file: ``elastica-gym play scripts/examples/my_policy.py --env elastica_gym/SnakeForward-v1``.

The file is executed again for every episode, so module variables may hold state.
"""

import numpy as np

FREQUENCY = 1.5
"""Of the wave [1/s]"""

steps = 0


def policy(observation: np.ndarray) -> np.ndarray:
    """Return a wave of the muscles that bend sideways: observation (159,), activations (42,)."""
    global steps
    phase = 2.0 * np.pi * FREQUENCY * 0.05 * steps
    steps += 1
    action = np.zeros(42)
    # indices 3 to 6 of each half are the four narrow functions, from tail to head
    action[3:7] = np.sin(phase - 0.4 * np.arange(4))
    action[10:14] = np.sin(phase - 0.4 * np.arange(4, 8))
    return action
