"""Seeds of episodes: different runs, validation, tests and scores share none.

Episode i of an evaluation has the seed s + i. NumPy's ``SeedSequence`` derives the seeds of a run's training
environments, or of a search's initial states, from the seed of the run; later episodes of an environment continue with
the same generator. Runs with different seeds therefore have independent initial states.
"""

import numpy as np

from ..console.bad_input import BadInputError

RUNS = range(0, 1 << 32)
"""Seeds of training runs and searches"""
TRAINED = 1 << 62
"""Bit set in all seeds of training environments; seeds of evaluations are smaller"""
VALIDATION = range(1_000_000, 2_000_000)
"""Seeds of evaluations during training, for choosing configurations and checkpoints"""
TEST = range(2_000_000, 3_000_000)
"""Seeds of published evaluations, never used to choose anything"""
SCORED = 1 << 63
"""Bit set in all seeds of the targets of `scripts/score.py`"""


def check_seeds(name: str, first: int, count: int, allowed: range) -> None:
    """Check that `count` consecutive seeds from `first` are allowed."""
    last = allowed.stop - count
    if not allowed.start <= first <= last:
        used = f": {count} seeds from there on are used" if count > 1 else ""
        raise BadInputError(f"{name} must be from {allowed.start} to {last}, got {first}{used}")


def training_seeds(run_seed: int, first: int, count: int) -> list[int]:
    """Return seeds `first` to `first + count - 1` of a run's training environments or initial states."""
    drawn = np.random.SeedSequence(run_seed).generate_state(first + count, np.uint64)
    return [TRAINED | int(each) >> 2 for each in drawn[first:]]


def target_seeds(target_seed: int, stream: int, n: int) -> list[int]:
    """Return the seeds of n scored episodes, which differ between streams."""
    drawn = np.random.SeedSequence([target_seed, stream]).generate_state(n, np.uint64)
    return [SCORED | int(each) for each in drawn]
