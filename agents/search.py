"""Search a gait by CMA-ES: ``python -m agents.search --env elastica_gym/SnakeForward-v1``."""

from elastica_gym.commands import run

if __name__ == "__main__":
    run("search")
