"""Scripts that import ``elastica``."""

import subprocess
import sys

SCRIPT = """
import sys
from elastica import *
import elastica as ea
import elastica.interaction
from elastica.boundary_conditions import ConstraintBase as SameBase
from elastica.modules import BaseSystemCollection as SameCollection
from elastica.typing import RodType

import neighbour

class Simulator(BaseSystemCollection, Constraints, CallBacks):
    pass

class Held(SameBase):
    def __init__(self, position, directors, **kwargs):
        super().__init__(**kwargs)
        self.position = position

    def constrain_values(self, system: RodType, time):
        system.position_collection[..., 0] = self.position

    def constrain_rates(self, system, time):
        system.velocity_collection[..., 0] = 0.0

rod = ea.CosseratRod.straight_rod(8, np.zeros(3), np.array([0, 0, 1.0]), np.array([0, 1.0, 0]), 0.3, 0.01, 1000.0,
                                  youngs_modulus=1e5)
sim, lists = Simulator(), defaultdict(list)
sim.append(rod)
sim.constrain(rod).using(Held, constrained_position_idx=(0,), constrained_director_idx=(0,))
sim.collect_diagnostics(rod).using(ea.callback_functions.MyCallBack, step_skip=10, callback_params=lists)
sim.finalize()
integrate(PositionVerlet(), sim, 1e-3, 100, progress_bar=False)
assert SameCollection is BaseSystemCollection and ea.interaction.SlenderBodyTheory is SlenderBodyTheory
print(sys.argv[1:], len(lists["time"]), neighbour.ANSWER)
"""


def run(*arguments):
    return subprocess.run([sys.executable, *arguments], capture_output=True, text=True, check=False)


def test_a_script_runs_unchanged(tmp_path):
    (tmp_path / "script.py").write_text(SCRIPT)
    (tmp_path / "neighbour.py").write_text("ANSWER = 42")
    done = run("-m", "elastica_gym.cosserat", tmp_path / "script.py", "--flag")
    assert done.stdout.strip() == "['--flag'] 11 42", done.stderr


def test_errors():
    assert "script.py" in run("-m", "elastica_gym.cosserat").stderr
    code = "import sys, types; sys.modules['elastica'] = types.ModuleType('elastica'); "
    code += "sys.modules['elastica'].__file__ = 'there'; "
    code += "from elastica_gym.cosserat.alias import stand_in_for_elastica; stand_in_for_elastica()"
    assert "already imported, from there" in run("-c", code).stderr
