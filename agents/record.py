"""Record a dataset: ``python -m agents.record --policy scripted --env ID --episodes N --dataset NAME``."""

from elastica_gym.commands import run

if __name__ == "__main__":
    run("record")
