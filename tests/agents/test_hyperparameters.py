import pytest
import yaml
from stable_baselines3.common.utils import LinearSchedule
from torch import nn

from agents import hyperparameters
from agents.checks import EXTRAS, BadInputError
from elastica_gym.envs import IDS
from tests.agents.commands import FORWARD, ROOT


@pytest.mark.parametrize("algo", hyperparameters.ALGORITHMS)
def test_every_environment_has_hyperparameters(algo):
    for env_id in IDS:
        values = hyperparameters.load(algo, env_id)
        assert values["n_timesteps"] > 0
        assert "policy" in hyperparameters.algorithm_arguments(values)


def test_overrides_go_before_the_file():
    overrides = hyperparameters.parse_overrides(["gamma=0.9", "learning_rate=lin_0.01", "env_kwargs={duration: 2.0}"])
    values = hyperparameters.load("ppo", FORWARD, overrides=overrides)
    assert values["gamma"] == 0.9
    assert values["env_kwargs"] == {"duration": 2.0}
    schedule = hyperparameters.algorithm_arguments(values)["learning_rate"]
    assert isinstance(schedule, LinearSchedule)
    assert schedule(1.0) == 0.01 and schedule(0.25) == pytest.approx(0.0025)
    assert hyperparameters.normalize_arguments(values)["gamma"] == 0.9


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("dict(net_arch=[64, 64], log_std_init=-1.5)", {"net_arch": [64, 64], "log_std_init": -1.5}),
        ("dict(net_arch=dict(pi=[8], vf=[9]))", {"net_arch": {"pi": [8], "vf": [9]}}),
        ("{'a': (1, 2)}", {"a": (1, 2)}),
        ("dict(activation_fn=nn.Tanh)", {"activation_fn": nn.Tanh}),
    ],
)
def test_strings_of_python_are_read_as_rl_zoo3_evaluates_them(text, value):
    assert hyperparameters.literal(text) == value == eval(text)


@pytest.mark.parametrize("text", ["__import__('os')", "dict(a=open('x'))", "[x for x in (1,)]", "dict(", "nn.nothing"])
def test_nothing_else_is_read(text):
    with pytest.raises(BadInputError):
        hyperparameters.literal(text)


@pytest.mark.parametrize(
    ("normalize", "wanted"), [(False, None), (True, {}), ({"norm_obs": False}, {"norm_obs": False})]
)
def test_normalisation_as_rl_zoo3_reads_it(normalize, wanted):
    values = {"normalize": normalize, "gamma": 0.5}
    assert hyperparameters.normalize_arguments(values) == (wanted if wanted is None else {**wanted, "gamma": 0.5})


def test_a_wrong_file_is_told(tmp_path):
    path = tmp_path / "ppo.yml"
    with pytest.raises(BadInputError, match="Cannot read"):
        hyperparameters.load("ppo", FORWARD, config=path)
    path.write_text("a: [")
    with pytest.raises(BadInputError, match="not YAML"):
        hyperparameters.load("ppo", FORWARD, config=path)
    path.write_text(yaml.safe_dump({"other": {}}))
    with pytest.raises(BadInputError, match="no entry"):
        hyperparameters.load("ppo", FORWARD, config=path)
    path.write_text(yaml.safe_dump({FORWARD: {"n_step": 5}}))
    with pytest.raises(BadInputError, match=r"n_step.*did you mean 'n_steps'"):
        hyperparameters.load("ppo", FORWARD, config=path)


def test_lowest_versions_are_those_of_the_package():
    import tomllib

    groups = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["optional-dependencies"]
    # those that are for users, and not for who works on the package
    assert set(EXTRAS) == set(groups) - {"test", "bench"}
    for extra, packages in EXTRAS.items():
        assert {f"{package}>={lowest}" for package, lowest in packages.items()} == set(groups[extra])
