"""The 2020 hackathon: its environment, and the scorer, which runs policies in a process of their own."""

from .environment import Environment

__all__ = ["Environment"]
