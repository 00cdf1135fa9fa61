"""The compiled physics by subject, and step.py, which puts it together."""
