"""The commands, as modules: ``python -m agents.train`` is ``elastica-gym train``."""
