"""Stable-Baselines3 on the native batch: ``python scripts/examples/sb3_ppo.py``."""

import argparse

from stable_baselines3 import PPO
from stable_baselines3.common.vec_env import VecMonitor, VecNormalize

from elastica_gym.rl import make_batch_vec_env


def main() -> None:
    """Train a snake with SB3's own loop."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--env", default="elastica_gym/SnakeForward-v1")
    parser.add_argument("--steps", type=int, default=300_000)
    parser.add_argument("--num-envs", type=int, default=64)
    arguments = parser.parse_args()
    env = VecNormalize(VecMonitor(make_batch_vec_env(arguments.env, n_envs=arguments.num_envs)))
    model = PPO(
        "MlpPolicy",
        env,
        n_steps=50,
        batch_size=25 * arguments.num_envs // 2,
        n_epochs=8,
        gamma=0.98,
        gae_lambda=0.92,
        target_kl=0.15,
        learning_rate=6e-4,
        policy_kwargs={"net_arch": [128, 128], "log_std_init": -1.0},
        verbose=1,
        device="cpu",
        seed=0,
    )
    model.learn(arguments.steps)
    model.save("snake_ppo")
    env.save("snake_ppo_normalization.pkl")
    print("wrote snake_ppo.zip and snake_ppo_normalization.pkl")


if __name__ == "__main__":
    main()
