"""One animal as a gymnasium.Env: a thin view of a batch of one."""

from typing import TYPE_CHECKING, Any

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode

from ..engine.model import Array
from .batch import RENDER_MODES, BatchEnv, Observations
from .task import Task

if TYPE_CHECKING:
    from ..viz.frames import Image


class SingleEnv(gymnasium.Env):
    """One animal performing a task. Made by ``gymnasium.make("elastica_gym/<Name>-v1")``.

    Parameters
    ----------
    task : Task
    render_mode : str, optional
        ``"rgb_array"``, with which `render` draws a picture. ``gymnasium.make`` also takes ``"rgb_array_list"``, which
        collects the pictures of an episode, and ``"human"``, which shows them in a window and needs pygame.
    **kwargs
        Arguments of `BatchEnv`.

    Attributes
    ----------
    batch : BatchEnv
        The batch of one.
    """

    def __init__(self, task: Task, *, render_mode: str | None = None, **kwargs: Any) -> None:
        self.batch = BatchEnv(task, 1, render_mode=render_mode, autoreset_mode=AutoresetMode.DISABLED, **kwargs)
        self.metadata = {"render_modes": list(RENDER_MODES), "render_fps": self.batch.metadata["render_fps"]}
        self.observation_space = self.batch.single_observation_space
        self.action_space = self.batch.single_action_space
        self.render_mode = render_mode

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observations, dict[str, Any]]:
        """Start a new episode; see `BatchEnv.reset`."""
        super().reset(seed=seed)
        # the batch draws from this environment's own generator, including one set by the user
        self.batch._generators, self.batch._seeds = [self.np_random], [self.np_random_seed]
        observations, info = self.batch.reset(options=options)
        return observations[0], _values(info)

    def step(self, action: Array) -> tuple[Observations, float, bool, bool, dict[str, Any]]:
        """Advance by one control step; see `BatchEnv.step`."""
        values = np.asarray(action)
        if values.shape != self.action_space.shape:
            raise ValueError(f"action must have shape {self.action_space.shape}, not {values.shape}")
        observations, rewards, terminated, truncated, info = self.batch.step(values[None])
        return observations[0], float(rewards[0]), bool(terminated[0]), bool(truncated[0]), _values(info)

    def render(self) -> "Image | None":
        """Draw the animal's current state, (height, width, 3) uint8; see `BatchEnv.render`."""
        frames = self.batch.render()
        return None if frames is None else frames[0]

    def close(self) -> None:
        """Close the batch."""
        self.batch.close()

    @property
    def termination_reasons(self) -> tuple[str, ...]:
        """Names of the reasons by number; see `BatchEnv.termination_reasons`."""
        return self.batch.termination_reasons

    def get_state(self) -> dict[str, Any]:
        """Return everything that determines the future; see `BatchEnv.get_state`."""
        return self.batch.get_state()

    def set_state(self, saved: dict[str, Any]) -> None:
        """Continue from a result of `get_state`."""
        self.batch.set_state(saved)
        if self.batch._generators is not None:
            self._np_random, self._np_random_seed = self.batch._generators[0], self.batch._seeds[0]


def _values(info: dict[str, Any]) -> dict[str, Any]:
    """Return the values of the one environment, without the masks."""
    return {name: value.item(0) for name, value in info.items() if not name.startswith("_")}
