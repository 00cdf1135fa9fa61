"""Open a recording in the rerun viewer: ``python scripts/replay.py FILE``, or with ``--web`` in a browser."""

from elastica_gym.commands import run

if __name__ == "__main__":
    run("replay")
