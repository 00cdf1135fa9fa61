"""The environments: tasks for animals, in batches."""

from .batch import BatchEnv
from .documentation import document
from .goal import GoalTask, goal_conditioned
from .registration import GOAL_IDS, IDS, observation_names, register, register_all, registered_ids, task_of
from .single import SingleEnv
from .task import Situation, Task, TerminationReason

__all__ = [
    "GOAL_IDS",
    "IDS",
    "BatchEnv",
    "GoalTask",
    "SingleEnv",
    "Situation",
    "Task",
    "TerminationReason",
    "document",
    "goal_conditioned",
    "observation_names",
    "register",
    "register_all",
    "registered_ids",
    "task_of",
]
