"""Plot learning curves over seeds: ``python -m agents.plot_curves --env ID --runs runs/SnakeForward-v1/ppo-*``."""

from elastica_gym.commands import run

if __name__ == "__main__":
    run("plot_curves")
