"""Stable-Baselines3: adapter, training, imitation, policies, evaluation and cards.

`BatchVecEnv` adapts any Gymnasium vector environment to Stable-Baselines3; `make_batch_vec_env` makes one from an
environment id of this package.
"""

from typing import Any

__all__ = ["BatchVecEnv", "make_batch_vec_env"]


def __getattr__(name: str) -> Any:
    # lazy: Stable-Baselines3 takes seconds to import
    if name in __all__:
        from . import vec_env

        return getattr(vec_env, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
