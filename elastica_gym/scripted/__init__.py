"""Policies written by hand: gaits, and a script for each task, found by the task's name."""

from .scripts import Script, register_script, scripted_policy

__all__ = ["Script", "register_script", "scripted_policy"]
