"""The tasks, a file each: the specification first, then its code."""
