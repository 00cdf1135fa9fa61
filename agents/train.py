"""Train an agent: ``python -m agents.train --env elastica_gym/SnakeForward-v1 --algo ppo``."""

from elastica_gym.commands import run

if __name__ == "__main__":
    run("train")
