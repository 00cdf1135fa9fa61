"""Reinforcement learning on soft animals.

``import elastica_gym`` registers the environments with Gymnasium::

    import elastica_gym, gymnasium
    env = gymnasium.make("elastica_gym/SnakeForward-v1")
    envs = gymnasium.make_vec("elastica_gym/SnakeForward-v1", num_envs=64)

With ``render_mode="rgb_array"``, ``env.render()`` draws pictures. `register` adds tasks of your own.
"""

from .versions import require_versions

# before what compiles: with another Numba that ends in an error which does not name the cause
require_versions()

from .envs import register, register_all  # noqa: E402

__all__ = ["register", "register_all"]
__version__ = "0.1.0"

register_all()
