"""Trials: a policy on many parallel targets, with the State sampled every 10 ms or finer."""

import itertools
import math
from collections.abc import Callable, Sequence
from typing import Any

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode

import elastica_gym  # noqa: F401  registers the environments

from ..bodies import grip
from ..bodies.body import activate
from ..engine import State
from ..engine.model import make_control, make_state
from ..engine.threads import Team
from .scoring import Samples, goals_held

SAMPLE_TIME = 0.01
"""Maximum time between samples [s]"""
STEPS_BETWEEN_LOOKS = 20
"""Control steps between checks for episodes that achieved all goals"""

Actor = Callable[[np.ndarray, tuple[int, ...]], np.ndarray]
"""Function from observations (n, d) and the shape of the actions to actions"""


class Sampler:
    """Samples of a batch of environments, also within control steps.

    The batch itself runs unchanged, bit for bit. Samples within a control step come from a copy of its state, which
    runs the same step in parts and is copied again before the next. Finished episodes are not copied.

    Parameters
    ----------
    batch
        A `BatchEnv` of animals with an object, which has been reset.
    """

    def __init__(self, batch: Any):
        self._batch = batch
        model, n = batch.body.model, batch.num_envs
        self._copy, self._control = make_state(model, n), make_control(model, n)
        self._team = Team(model, self._copy, self._control, batch.n_threads)
        n_parts = math.ceil(batch.n_substeps / math.floor(SAMPLE_TIME / batch.sim_dt + 1e-9))
        cuts = [batch.n_substeps * part // n_parts for part in range(n_parts + 1)]
        # the end of the control step is sampled from the batch itself
        self._parts = [end - begin for begin, end in itertools.pairwise(cuts)][:-1]
        self.is_over = np.zeros(n, dtype=bool)
        self._times: list[float] = []
        self._moments: list[tuple[np.ndarray, ...]] = []
        self._look(batch.state, np.arange(n))

    def before(self, actions: np.ndarray) -> None:
        """Take the samples within a control step, before the batch executes it."""
        batch, going = self._batch, np.flatnonzero(~self.is_over)
        for copied, field in zip((*self._copy, *self._control), (*batch.state, *batch.control), strict=True):
            copied[: going.size] = field[going]
        # same as in the batch
        levels = np.clip(np.asarray(actions, dtype=np.float64), -1.0, 1.0)
        activate(batch.body.couples, levels[going], self._control.couple[: going.size])
        for n_substeps in self._parts:
            self._team.advance(going.size, batch.sim_dt, n_substeps)
            self._look(self._copy, going)

    def after(self) -> None:
        """Find failed episodes, then take the sample at the end of a control step."""
        going = np.flatnonzero(~self.is_over)
        situation = self._batch.situation()
        self.is_over |= situation.pose.sound == 0
        for failed in self._batch.task.failures.values():
            self.is_over |= failed(situation)
        self._look(State._make(field[going] for field in self._batch.state), going)

    def samples(self) -> Samples:
        """Return all samples."""
        return Samples(np.array(self._times), *(np.array(series) for series in zip(*self._moments, strict=True)))

    def _look(self, state: State, going: np.ndarray) -> None:
        """Sample the first states, which are those of the running environments."""
        n, plane, body = going.size, [0, 2], self._batch.body
        x, mass = state.x[:n, plane], body.model.mass
        hold = grip(body, State._make(field[:n] for field in state))
        seen: tuple[Any, ...] = (
            ~self.is_over[going],
            x[..., body.sensors.head],
            (x * mass).sum(axis=2) / mass.sum(),
            hold.head_gap,
            hold.touching.any(axis=1),
            hold.base[:, plane],
            hold.tilt,
            hold.spans,
            hold.counts,
        )
        self._times.append(float(state.time[:n].max()))
        if self._moments:
            new, seen = seen, tuple(map(np.copy, self._moments[-1]))
            # finished episodes keep their last sample, which does not count
            seen[0][:] = False
            for kept, fresh in zip(seen, new, strict=True):
                kept[going] = fresh
        self._moments.append(seen)


def run_trials(
    actor: Actor,
    env_id: str,
    *,
    seeds: Sequence[int],
    watch: Callable[[Any, Sampler, dict[str, Any] | None], None],
    **env_kwargs: Any,
) -> Samples:
    """Run one episode per seed, in parallel, and return their samples.

    Episodes end on failure, when all goals are achieved, or at the time limit, but not on the task's success.

    Parameters
    ----------
    actor
        The policy.
    env_id
        Id of an environment with an animal and its object.
    seeds
        Seed of each episode.
    watch
        Called at the start and after each control step with batch, sampler and the info of the step, None at the start.
    **env_kwargs
        Arguments of the environment.
    """
    env = gymnasium.make_vec(env_id, num_envs=len(seeds), autoreset_mode=AutoresetMode.DISABLED, **env_kwargs)
    batch: Any = env.unwrapped
    observations, _ = batch.reset(seed=list(seeds))
    sampler = Sampler(batch)
    try:
        watch(batch, sampler, None)
        for step in range(1, batch.max_episode_steps + 1):
            actions = actor(observations, batch.action_space.shape)
            sampler.before(actions)
            observations, _, _, _, infos = batch.step(actions)
            sampler.after()
            watch(batch, sampler, infos)
            if step % STEPS_BETWEEN_LOOKS == 0:
                sampler.is_over |= goals_held(sampler.samples())[-1]
            if sampler.is_over.all():
                break
        return sampler.samples()
    finally:
        env.close()
