"""The tasks, one file each: the specification first, then its code."""
