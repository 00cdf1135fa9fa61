"""The compiled physics: a file for each piece of it, and step.py, which puts them together."""
