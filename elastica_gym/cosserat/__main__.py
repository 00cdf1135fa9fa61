"""Run a script written for PyElastica: ``python -m elastica_gym.cosserat script.py [arguments]``."""

import runpy
import sys
from pathlib import Path

from .alias import stand_in_for_elastica

if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    stand_in_for_elastica()
    del sys.argv[0]
    # as Python does for a script
    sys.path.insert(0, str(Path(sys.argv[0]).resolve().parent))
    runpy.run_path(sys.argv[0], run_name="__main__")
