"""Score a policy on the hackathon's goals: ``python scripts/score.py --policy PATH``."""

from elastica_gym.commands import run

if __name__ == "__main__":
    run("score")
