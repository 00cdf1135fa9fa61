"""Seeds of episodes: those of different trainings, of validation, of tests and of scores have none in common.

Episode i of an evaluation is drawn with the seed s + i. The environments of a training, or the starts of a search, have
seeds that NumPy's ``SeedSequence`` derives from that of the run, and each later episode of an environment continues
with the same generator. So runs of different seeds are independent samples of starts.
"""

import numpy as np

from ..console.bad_input import BadInputError

RUNS = range(0, 1 << 32)
"""Of trainings and searches as a whole"""
TRAINED = 1 << 62
"""The bit that all seeds of training environments have, which those of evaluations do not reach"""
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
        used = f": {count} seeds from there on are used" if count > 1 else ""
        raise BadInputError(f"{name} must be from {allowed.start} to {last}, got {first}{used}")


def training_seeds(run_seed: int, first: int, count: int) -> list[int]:
    """Return seeds number first to first + count - 1 of the training environments, or starts, of a run."""
    drawn = np.random.SeedSequence(run_seed).generate_state(first + count, np.uint64)
    return [TRAINED | int(each) >> 2 for each in drawn[first:]]


def target_seeds(target_seed: int, stream: int, n: int) -> list[int]:
    """Return the seeds of the n scored episodes of a target seed, which differ between streams."""
    drawn = np.random.SeedSequence([target_seed, stream]).generate_state(n, np.uint64)
    return [SCORED | int(each) for each in drawn]
