"""PPO of SBX, Stable-Baselines3 in JAX, on the native batch: ``python scripts/examples/engines/sbx_ppo.py``."""

import argparse

import numpy as np
from sbx import PPO
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.vec_env import VecNormalize

from elastica_gym.rl import make_batch_vec_env


class Report(BaseCallback):
    """Print the mean return of the last 100 episodes after each rollout."""

    def _on_step(self) -> bool:
        return True

    def _on_rollout_end(self) -> None:
        returns = [episode["r"] for episode in self.model.ep_info_buffer]
        if returns:
            print(f"steps {self.num_timesteps:>8,}  return {np.mean(returns):8.3f}", flush=True)


def main() -> None:
    """Train a snake by PPO, compiled by JAX."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--env", default="elastica_gym/SnakeForward-v1")
    parser.add_argument("--steps", type=int, default=300_000)
    parser.add_argument("--num-envs", type=int, default=64)
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    env = VecNormalize(make_batch_vec_env(arguments.env, n_envs=arguments.num_envs))
    model = PPO(
        "MlpPolicy",
        env,
        n_steps=40,
        batch_size=5 * arguments.num_envs,
        n_epochs=8,
        gamma=0.98,
        gae_lambda=0.92,
        learning_rate=1e-3,
        policy_kwargs={"net_arch": [128, 128], "log_std_init": -1.0},
        seed=arguments.seed,
    )
    model.learn(arguments.steps, Report())
    env.close()


if __name__ == "__main__":
    main()
