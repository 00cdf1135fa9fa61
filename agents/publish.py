"""Make a pretrained policy from a run: ``python -m agents.publish --name snake_forward_ppo --run DIR``."""

from elastica_gym.commands import run

if __name__ == "__main__":
    run("publish")
