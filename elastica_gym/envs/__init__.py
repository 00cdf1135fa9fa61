"""The environments: tasks for animals, in batches."""

from .batch import BatchEnv
from .hackathon import Environment
from .registration import GOAL_IDS, IDS, TASKS, register_all
from .single import SingleEnv
from .task import Situation, Task, TerminationReason

__all__ = ["GOAL_IDS", "IDS", "TASKS", "BatchEnv", "Environment", "SingleEnv", "Situation", "Task", "TerminationReason",
           "register_all"]  # fmt: skip
