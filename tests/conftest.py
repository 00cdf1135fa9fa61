import importlib.util

import pytest
from hypothesis import settings

# the same examples in every run, so that a new failure is a regression; new examples with
# --hypothesis-profile=explore
settings.register_profile("repeat", deadline=None, derandomize=True)
settings.register_profile("explore", deadline=None, print_blob=True)
settings.load_profile("repeat")


@pytest.fixture(scope="session")
def cannot_draw() -> str:
    """Reason why MuJoCo cannot render here, or an empty string."""
    # without importing it first: MuJoCo chooses its renderer at import
    if importlib.util.find_spec("mujoco") is None:
        return "mujoco is not installed"
    from elastica_gym.viz import Stage

    try:
        with Stage(width=16, height=16):
            return ""
    except RuntimeError as error:
        return str(error)


@pytest.fixture(scope="session")
def offscreen(cannot_draw):
    """Skip if MuJoCo cannot render."""
    if cannot_draw:
        pytest.skip(cannot_draw)
