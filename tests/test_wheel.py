"""The wheel: all that a clone has, but for the tests, and no module that others own."""

import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from elastica_gym.files import shipped

ROOT = Path(__file__).parents[1]


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    pytest.importorskip("setuptools", minversion="77")
    folder, source = tmp_path_factory.mktemp("wheel"), tmp_path_factory.mktemp("source")
    files = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True).stdout.split()
    for name in files or pytest.skip("not a clone"):
        if (ROOT / name).exists() and not name.startswith(("tests/", "docs/")):
            (source / name).parent.mkdir(parents=True, exist_ok=True)
            (source / name).write_bytes((ROOT / name).read_bytes())
    build = ["-m", "pip", "wheel", "--no-deps", "--no-build-isolation", "-q", "-w", str(folder), str(source)]
    done = subprocess.run([sys.executable, *build], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return next(folder.glob("*.whl"))


def test_the_wheel_has_configurations_policies_and_types(wheel):
    names = set(zipfile.ZipFile(wheel).namelist())
    for folder in ("configs", "pretrained", "searched"):
        assert {f"elastica_gym/{folder}/{path.name}" for path in shipped(folder).glob("*.*")} <= names
    assert "elastica_gym/py.typed" in names
    assert {name.partition("/")[0] for name in names if not name.partition("/")[0].endswith(".dist-info")} == {
        "elastica_gym"
    }


def test_the_wheel_works_where_it_is_unpacked(wheel, tmp_path):
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(tmp_path)
    code = (
        "import elastica_gym; from elastica_gym.rl import cards, hyperparameters; from pathlib import Path;"
        "assert Path(elastica_gym.__file__).is_relative_to(Path.cwd());"
        "assert 'snake_forward_ppo' in cards.names();"
        "print(hyperparameters.load('ppo', 'elastica_gym/SnakeForward-v1')['n_envs'])"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True)
    assert done.stdout.strip() == "64", done.stderr
