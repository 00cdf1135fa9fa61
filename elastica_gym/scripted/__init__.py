"""Hand-written policies: gaits, and a script for each task, looked up by the task's name."""

from .scripts import Script, register_script, scripted_policy

__all__ = ["Script", "register_script", "scripted_policy"]
