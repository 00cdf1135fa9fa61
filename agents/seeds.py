"""Seeds of episodes: training, validation and test have none in common.

Episode i of a batch, and of an evaluation, begins with the generator of seed s + i; further episodes of an environment
in training go on with the same generator. So what begins in one of these ranges stays in it. Trainings whose seeds
differ by less than their number of environments share some of the generators of starts, in other places of the batch.
"""

import numpy as np

from agents.checks import BadInputError

TRAINING = range(0, 1_000_000)
"""Of environments that are trained in"""
VALIDATION = range(1_000_000, 2_000_000)
"""Of evaluations during training, by which configurations and checkpoints may be chosen"""
TEST = range(2_000_000, 3_000_000)
"""Of evaluations whose numbers are published, by which nothing is chosen"""
SCORED = 1 << 63
"""The bit that all seeds have with which `scripts/score.py` draws its targets"""


def check_seeds(name: str, first: int, count: int, allowed: range) -> None:
    """Make sure that `count` seeds from the first on are all allowed ones."""
    last = allowed.stop - count
    if not allowed.start <= first <= last:
        raise BadInputError(f"{name} must be from {allowed.start} to {last}, got {first}: "
                            f"{count} seeds from there on are used")  # fmt: skip


def target_seeds(target_seed: int, stream: int, n: int) -> list[int]:
    """Return the seeds of the n scored episodes of a target seed, which differ between streams."""
    drawn = np.random.SeedSequence([target_seed, stream]).generate_state(n, np.uint64)
    return [SCORED | int(each) for each in drawn]
