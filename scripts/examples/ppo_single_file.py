"""PPO in one file, on the native batch: ``python scripts/examples/ppo_single_file.py --steps 300000``.

The algorithm of Schulman et al. 2017 with generalised advantages, in the manner of CleanRL. The batch resets its
environments in the step after the one that ended an episode (NEXT_STEP), so the transition of that step is no
experience: its weight is zero.
"""

import dataclasses
import itertools
import time

import gymnasium
import numpy as np
import torch
import tyro
from torch import nn
from torch.distributions import Normal

import elastica_gym  # noqa: F401  registers the environments


@dataclasses.dataclass
class Arguments:
    """Train a policy by PPO."""

    env: str = "elastica_gym/SnakeForward-v1"
    """Environment id."""
    steps: int = 300_000
    """Environment steps."""
    num_envs: int = 64
    """Environments in the batch."""
    rollout: int = 50
    """Control steps between two updates."""
    epochs: int = 8
    """Passes over each rollout."""
    minibatches: int = 4
    """Parts of each pass."""
    learning_rate: float = 6e-4
    """At the start; it falls linearly to zero."""
    gamma: float = 0.98
    """Discount per control step."""
    gae_lambda: float = 0.92
    """Decay of generalised advantages."""
    clip: float = 0.2
    """Bound on the change of probability ratios."""
    seed: int = 0
    """Seed of networks, exploration and environments."""


class RunningNorm:
    """Mean and variance of what it has seen, by Welford's method over batches."""

    def __init__(self, size: int):
        self.mean, self.variance, self.count = np.zeros(size), np.ones(size), 1e-4

    def update(self, x: np.ndarray) -> None:
        """Take in rows (n, size), of which there may be none."""
        if not len(x):
            return
        mean, variance, n = x.mean(axis=0), x.var(axis=0), len(x)
        delta, total = mean - self.mean, self.count + n
        self.variance = (self.variance * self.count + variance * n + delta**2 * self.count * n / total) / total
        self.mean, self.count = self.mean + delta * n / total, total

    def __call__(self, x: np.ndarray) -> torch.Tensor:
        """Return rows with mean 0 and variance 1, clipped to 10."""
        scaled = (x - self.mean) / np.sqrt(self.variance + 1e-8)
        return torch.as_tensor(np.clip(scaled, -10.0, 10.0), dtype=torch.float32)


class Agent(nn.Module):
    """Two networks of two layers: the mean action, and the value."""

    def __init__(self, n_observations: int, n_actions: int):
        super().__init__()
        self.actor, self.critic = self._network(n_observations, n_actions, 0.01), self._network(n_observations, 1, 1.0)
        self.log_std = nn.Parameter(torch.full((n_actions,), -1.0))

    @staticmethod
    def _network(inputs: int, outputs: int, gain: float) -> nn.Sequential:
        sizes = [inputs, 128, 128, outputs]
        layers: list[nn.Module] = []
        for i, (a, b) in enumerate(itertools.pairwise(sizes)):
            layer = nn.Linear(a, b)
            nn.init.orthogonal_(layer.weight, gain if i == 2 else 2.0**0.5)
            nn.init.zeros_(layer.bias)
            layers += [layer] if i == 2 else [layer, nn.Tanh()]
        return nn.Sequential(*layers)

    def distribution(self, observations: torch.Tensor) -> Normal:
        """Return the distribution of actions."""
        return Normal(self.actor(observations), self.log_std.exp())


def advantages_of(
    rewards: np.ndarray, values: np.ndarray, ended: np.ndarray, terminated: np.ndarray, gamma: float, decay: float
) -> np.ndarray:
    """Return generalised advantages, (T, B); ``values`` has one row more. A truncated episode bootstraps."""
    advantages, last = np.zeros_like(rewards), np.zeros(rewards.shape[1])
    for t in reversed(range(len(rewards))):
        delta = rewards[t] + gamma * values[t + 1] * ~terminated[t] - values[t]
        last = advantages[t] = delta + gamma * decay * last * ~ended[t]
    return advantages


def main() -> None:
    """Train, and print the mean return of the episodes that ended in each rollout."""
    a = tyro.cli(Arguments)
    torch.manual_seed(a.seed)
    torch.set_num_threads(1)
    envs = gymnasium.make_vec(a.env, num_envs=a.num_envs)
    n, m = envs.single_observation_space.shape[0], envs.single_action_space.shape[0]
    agent, norm, scale = Agent(n, m), RunningNorm(n), RunningNorm(1)
    optimizer = torch.optim.Adam(agent.parameters(), lr=a.learning_rate, eps=1e-5)
    observation, _ = envs.reset(seed=a.seed)
    norm.update(observation)
    over = np.zeros(a.num_envs, dtype=bool)
    returns, discounted = np.zeros(a.num_envs), np.zeros(a.num_envs)
    steps, started, last = 0, time.perf_counter(), float("nan")
    while steps < a.steps:
        optimizer.param_groups[0]["lr"] = a.learning_rate * (1.0 - steps / a.steps)
        shape = (a.rollout, a.num_envs)
        obs, acts, logs = torch.zeros(*shape, n), torch.zeros(*shape, m), torch.zeros(shape)
        rewards, values = np.zeros(shape), np.zeros((a.rollout + 1, a.num_envs))
        ended, ends, counts = np.zeros(shape, bool), np.zeros(shape, bool), np.zeros(shape, bool)
        finished: list[float] = []
        for t in range(a.rollout):
            obs[t] = norm(observation)
            with torch.no_grad():
                distribution = agent.distribution(obs[t])
                acts[t] = distribution.sample()
                logs[t] = distribution.log_prob(acts[t]).sum(-1)
                values[t] = agent.critic(obs[t])[:, 0].numpy()
            counts[t] = ~over
            observation, reward, terminated, truncated, _ = envs.step(acts[t].clamp(-1.0, 1.0).numpy())
            norm.update(observation[~over])
            rewards[t], ends[t], over = np.where(over, 0.0, reward), terminated, terminated | truncated
            ended[t] = over
            returns += rewards[t]
            discounted = a.gamma * discounted + rewards[t]
            scale.update(discounted[:, None])
            finished += returns[over].tolist()
            returns[over] = discounted[over] = 0.0
        with torch.no_grad():
            values[-1] = agent.critic(norm(observation))[:, 0].numpy()
        rewards /= np.sqrt(scale.variance[0] + 1e-8)
        advantages = advantages_of(rewards, values, ended, ends, a.gamma, a.gae_lambda)
        weight = torch.as_tensor(counts.ravel(), dtype=torch.float32)
        data = obs.flatten(0, 1), acts.flatten(0, 1), logs.flatten()
        advantage = torch.as_tensor(advantages.ravel(), dtype=torch.float32)
        target = advantage + torch.as_tensor(values[:-1].ravel(), dtype=torch.float32)
        for _ in range(a.epochs):
            for rows in torch.randperm(len(advantage)).chunk(a.minibatches):
                distribution = agent.distribution(data[0][rows])
                ratio = (distribution.log_prob(data[1][rows]).sum(-1) - data[2][rows]).exp()
                scaled = (advantage[rows] - advantage[rows].mean()) / (advantage[rows].std() + 1e-8)
                gain = torch.min(ratio * scaled, ratio.clamp(1.0 - a.clip, 1.0 + a.clip) * scaled)
                error = (agent.critic(data[0][rows])[:, 0] - target[rows]) ** 2
                loss = (weight[rows] * (0.5 * error - gain)).sum() / weight[rows].sum()
                optimizer.zero_grad()
                loss.backward()
                nn.utils.clip_grad_norm_(agent.parameters(), 0.5)
                optimizer.step()
        steps += a.rollout * a.num_envs
        last = float(np.mean(finished)) if finished else last
        known = f"{last:8.2f}" if np.isfinite(last) else f"{'-':>8}"
        print(f"steps {steps:>8,}  return {known}  {steps / (time.perf_counter() - started):6.0f} steps/s", flush=True)
    envs.close()


if __name__ == "__main__":
    main()
