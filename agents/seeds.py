"""Seeds of episodes: training, validation and test have none in common.

Episode i of a batch, and of an evaluation, begins with the generator of seed s + i; further episodes of an environment
in training go on with the same generator. So what begins in one of these ranges stays in it.
"""

TRAINING = range(0, 1_000_000)
"""Of environments that are trained in"""
VALIDATION = range(1_000_000, 2_000_000)
"""Of evaluations during training, by which configurations and checkpoints may be chosen"""
TEST = range(2_000_000, 3_000_000)
"""Of evaluations whose numbers are published, by which nothing is chosen"""
