"""The 2020 hackathon: its environment, and the scorer, which runs policies in a separate process."""

from .environment import Environment

__all__ = ["Environment"]
