import re

import pytest
import yaml
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from stable_baselines3.common.utils import LinearSchedule
from stable_baselines3.common.vec_env import VecNormalize
from torch import nn

from elastica_gym.console.bad_input import BadInputError
from elastica_gym.envs import IDS
from elastica_gym.rl import hyperparameters
from elastica_gym.rl.algorithms import ALGORITHMS
from elastica_gym.rl.vec_env import make_batch_vec_env
from elastica_gym.versions import lowest_of
from tests.agents.commands import FORWARD, ROOT


@pytest.mark.parametrize("algo", ALGORITHMS)
def test_every_environment_has_hyperparameters(algo):
    for env_id in IDS:
        values = hyperparameters.load(algo, env_id)
        assert values["n_timesteps"] > 0
        assert "policy" in hyperparameters.algorithm_arguments(values)


def test_overrides_take_precedence_over_the_file():
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
def test_strings_of_python_are_parsed_as_rl_zoo3_evaluates_them(text, value):
    assert hyperparameters.literal(text) == value == eval(text)


@pytest.mark.parametrize("text", ["__import__('os')", "dict(a=open('x'))", "[x for x in (1,)]", "dict(", "nn.nothing"])
def test_other_expressions_are_refused(text):
    with pytest.raises(BadInputError):
        hyperparameters.literal(text)


@pytest.mark.parametrize(
    ("normalize", "wanted"), [(False, None), (True, {}), ({"norm_obs": False}, {"norm_obs": False})]
)
def test_normalisation_as_rl_zoo3_reads_it(normalize, wanted):
    values = {"normalize": normalize, "gamma": 0.5}
    assert hyperparameters.normalize_arguments(values) == (wanted if wanted is None else {**wanted, "gamma": 0.5})


def test_an_invalid_file_is_reported(tmp_path):
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
    # the groups for users, without those for developers
    for extra in set(groups) - {"test", "bench"}:
        wanted = {re.sub(r"\[\w+\]", "", line) for line in groups[extra]}
        assert {f"{package}>={lowest}" for package, lowest in lowest_of(extra).items()} == wanted


@pytest.mark.parametrize("algo", ALGORITHMS)
def test_every_key_has_allowed_values(algo):
    assert set(ALGORITHMS[algo].allowed) == hyperparameters.valid_keys(algo)


def test_numbers_that_yaml_reads_as_strings_are_converted():
    overrides = hyperparameters.parse_overrides(["ent_coef=1e-3", "n_timesteps=1e6", "learning_rate=3e-4"])
    values = hyperparameters.load("ppo", FORWARD, overrides=overrides)
    assert (values["ent_coef"], values["n_timesteps"], values["learning_rate"]) == (1e-3, 1_000_000, 3e-4)
    assert isinstance(values["n_timesteps"], int)


PLAIN = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(-3, 600),
    st.floats(),
    st.text(max_size=8),
    st.sampled_from(["lin_0.1", "lin_-1", "lin_x", "auto", "auto_0.1", "1e-3", "nan", "1e400", "MlpPolicy", "os.path"]),
)
INNER = st.dictionaries(st.sampled_from(["net_arch", "pi", "log_std_init", "norm_obs", "activation_fn"]), PLAIN)
ANYTHING = st.one_of(PLAIN, st.lists(PLAIN, max_size=3), INNER)


@pytest.fixture(scope="module")
def envs():
    return make_batch_vec_env(FORWARD, n_envs=2, n_threads=1)


@pytest.mark.parametrize("algo", ALGORITHMS)
@given(data=st.data())
@settings(max_examples=150, suppress_health_check=[HealthCheck.too_slow])
def test_values_are_refused_in_one_line_or_make_a_model(envs, algo, data):
    base = {"policy": "MlpPolicy", "policy_kwargs": {"net_arch": [4]}, "n_envs": 2, "buffer_size": 500, "n_steps": 5}
    names = sorted(hyperparameters.valid_keys(algo) - {"env_kwargs", "rollout_buffer_kwargs", "replay_buffer_kwargs"})
    key = data.draw(st.sampled_from(names))
    value = data.draw(ANYTHING)
    values = {k: v for k, v in base.items() if k in hyperparameters.valid_keys(algo)} | {key: value}
    try:
        values = hyperparameters.checked(algo, values)
    except BadInputError as error:
        assert key in str(error) and "\n" not in str(error)
        return
    normalize = hyperparameters.normalize_arguments(values)
    env = envs if normalize is None else VecNormalize(envs, **normalize)
    try:
        model = hyperparameters.algorithm_class(algo)(
            env=env, seed=0, device="cpu", **hyperparameters.algorithm_arguments(values)
        )
    except (AssertionError, ValueError):
        # invalid combinations are left to Stable-Baselines3
        assert key in ("policy", "batch_size", "n_steps", "use_sde", "optimize_memory_usage", "normalize_advantage")
        return
    assert model.gamma == values.get("gamma", 0.99)
