"""``python -m elastica_gym.commands`` is ``elastica-gym``."""

from . import main

main()
