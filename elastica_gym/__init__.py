"""Reinforcement learning on soft animals.

``import elastica_gym`` registers the environments with Gymnasium::

    import elastica_gym, gymnasium
    env = gymnasium.make("elastica_gym/SnakeForward-v1")
    envs = gymnasium.make_vec("elastica_gym/SnakeForward-v1", num_envs=64)

With ``render_mode="rgb_array"``, ``env.render()`` returns images. `register` adds your own tasks.
"""

from .versions import require_versions

# before the imports that compile: with another Numba they fail with an obscure error
require_versions()

from .envs import register, register_all  # noqa: E402

__all__ = ["register", "register_all"]
__version__ = "0.1.0"

register_all()
