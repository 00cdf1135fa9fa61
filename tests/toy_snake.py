"""A snake of 16 elements in episodes of 2 s, on which a learner improves within a minute: ``toy/SnakeForward-v0``."""

import gymnasium

from elastica_gym.envs import registration

gymnasium.register(
    "toy/SnakeForward-v0",
    entry_point=f"{registration.__name__}:make_single",
    vector_entry_point=registration.BATCH,
    kwargs={
        "task": "elastica_gym/SnakeForward-v1",
        "max_episode_steps": 40,
        "n_threads": 1,
        "body_kwargs": {"n_elements": 16},
    },
)
