"""The Stable-Baselines3 side: the adapter, training, imitation, policies, their evaluation and their cards.

`BatchVecEnv` adapts a batch to Stable-Baselines3; `make_batch_vec_env` makes one by its id.
"""

from typing import Any

__all__ = ["BatchVecEnv", "make_batch_vec_env"]


def __getattr__(name: str) -> Any:
    # Stable-Baselines3 takes seconds to import, and not all of this room needs it
    if name in __all__:
        from . import vec_env

        return getattr(vec_env, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
