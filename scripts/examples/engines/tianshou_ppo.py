"""PPO of Tianshou on the native batch: ``python scripts/examples/engines/tianshou_ppo.py``.

Tianshou makes a worker for each environment, and has no batches. `Batch` is one in its interface: all environments step
together, and those that Tianshou names are reset (AutoresetMode.DISABLED).
"""

import argparse

import gymnasium
import numpy as np
import torch
from gymnasium.vector import AutoresetMode
from tianshou.algorithm import PPO
from tianshou.algorithm.modelfree.reinforce import ProbabilisticActorPolicy
from tianshou.algorithm.optim import AdamOptimizerFactory
from tianshou.data import Collector, VectorReplayBuffer
from tianshou.env import BaseVectorEnv, VectorEnvNormObs
from tianshou.utils.net.common import Net
from tianshou.utils.net.continuous import ContinuousActorProbabilistic, ContinuousCritic
from tianshou.utils.torch_utils import policy_within_training_step
from torch.distributions import Independent, Normal

import elastica_gym  # noqa: F401  registers the environments

ROLLOUT = 40


class Batch(BaseVectorEnv):
    """A Gymnasium batch as Tianshou's vector environment."""

    def __init__(self, batch):
        self.batch, self.env_num = batch, batch.num_envs
        self.is_async, self.is_closed, self.waiting_id = False, False, []

    def get_env_attr(self, key, id=None):
        """Return what all environments share, once for each."""
        of_one = {"action_space": "single_action_space", "observation_space": "single_observation_space"}
        return [getattr(self.batch, of_one.get(key, key))] * self.env_num

    def reset(self, env_id=None, **kwargs):
        """Reset some environments, and return their observations."""
        ids = np.arange(self.env_num) if env_id is None else np.atleast_1d(env_id)
        mask = np.isin(np.arange(self.env_num), ids)
        observations, _ = self.batch.reset(options={"reset_mask": mask}, **kwargs)
        return observations[ids], np.array([{} for _ in ids])

    def step(self, action, id=None):
        """Step all environments."""
        *results, _ = self.batch.step(action)
        return *results, np.array([{"env_id": i} for i in range(self.env_num)])


def main() -> None:
    """Train a snake with Tianshou's collector and update."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--env", default="elastica_gym/SnakeForward-v1")
    parser.add_argument("--steps", type=int, default=300_000)
    parser.add_argument("--num-envs", type=int, default=64)
    parser.add_argument("--seed", type=int, default=0)
    a = parser.parse_args()
    np.random.seed(a.seed)
    torch.manual_seed(a.seed)
    batch = gymnasium.make_vec(a.env, num_envs=a.num_envs, autoreset_mode=AutoresetMode.DISABLED)
    spaces = {"observation_space": batch.single_observation_space, "action_space": batch.single_action_space}
    n, m = (space.shape[0] for space in spaces.values())
    hidden = {"state_shape": n, "hidden_sizes": (128, 128), "activation": torch.nn.Tanh}
    actor = ContinuousActorProbabilistic(preprocess_net=Net(**hidden), action_shape=m, unbounded=True)
    actor.mu.model[-1].weight.data *= 0.01
    actor.sigma_param.data.fill_(-1.0)
    # the batch clips actions itself
    ours = {"action_scaling": False, "action_bound_method": None, **spaces}
    policy = ProbabilisticActorPolicy(actor=actor, dist_fn=lambda p: Independent(Normal(*p), 1), **ours)
    critic = ContinuousCritic(preprocess_net=Net(**hidden))
    optim = AdamOptimizerFactory(lr=1e-3)
    algorithm = PPO(policy=policy, critic=critic, optim=optim, gamma=0.98, gae_lambda=0.92, return_scaling=True)
    size = ROLLOUT * a.num_envs
    collector = Collector(policy, VectorEnvNormObs(Batch(batch)), VectorReplayBuffer(size, a.num_envs))
    collector.reset(gym_reset_kwargs={"seed": a.seed})
    for steps in range(size, a.steps + 1, size):
        with policy_within_training_step(policy):
            stats = collector.collect(n_step=size)
            algorithm.update(collector.buffer, batch_size=size // 8, repeat=8)
        collector.reset_buffer(keep_statistics=True)
        if stats.n_collected_episodes:
            print(f"steps {steps:>8,}  return {np.mean(stats.returns):8.3f}", flush=True)
    batch.close()


if __name__ == "__main__":
    main()
