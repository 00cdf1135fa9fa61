"""Evaluate a policy: ``python -m agents.evaluate --run DIR``, ``--pretrained NAME`` or ``--policy NAME --env ID``."""

from elastica_gym.commands import run

if __name__ == "__main__":
    run("evaluate")
