"""Hindsight experience replay on a goal environment: ``python scripts/examples/hindsight.py``."""

import argparse

from stable_baselines3 import SAC, HerReplayBuffer

from elastica_gym.rl import make_batch_vec_env


def main() -> None:
    """Train SAC with relabelled goals."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--env", default="elastica_gym/SnakeReachGoal-v1")
    parser.add_argument("--steps", type=int, default=300_000)
    parser.add_argument("--num-envs", type=int, default=16)
    parser.add_argument("--learning-starts", type=int, default=6400)
    arguments = parser.parse_args()
    env = make_batch_vec_env(arguments.env, n_envs=arguments.num_envs)
    model = SAC(
        "MultiInputPolicy",
        env,
        replay_buffer_class=HerReplayBuffer,
        learning_starts=arguments.learning_starts,
        train_freq=4,
        verbose=1,
        device="cpu",
        seed=0,
    )
    model.learn(arguments.steps)
    model.save("snake_her")
    print("wrote snake_her.zip")


if __name__ == "__main__":
    main()
