"""Train over seeds and hyperparameters: ``python -m agents.sweep --seeds 0 1 2 --set gamma=0.95,0.98``."""

from elastica_gym.commands import run

if __name__ == "__main__":
    run("sweep")
