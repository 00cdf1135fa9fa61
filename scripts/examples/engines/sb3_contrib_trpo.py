"""TRPO of sb3-contrib on the native batch: ``python scripts/examples/engines/sb3_contrib_trpo.py``."""

import argparse

import numpy as np
from sb3_contrib import TRPO
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
    """Train a snake by natural policy gradients in a trust region (Schulman et al. 2015)."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--env", default="elastica_gym/SnakeForward-v1")
    parser.add_argument("--steps", type=int, default=300_000)
    parser.add_argument("--num-envs", type=int, default=64)
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    env = VecNormalize(make_batch_vec_env(arguments.env, n_envs=arguments.num_envs))
    model = TRPO(
        "MlpPolicy",
        env,
        n_steps=40,
        batch_size=320,
        gamma=0.98,
        gae_lambda=0.92,
        target_kl=0.05,
        policy_kwargs={"net_arch": [128, 128], "log_std_init": -1.0},
        device="cpu",
        seed=arguments.seed,
    )
    model.learn(arguments.steps, Report())
    env.close()


if __name__ == "__main__":
    main()
