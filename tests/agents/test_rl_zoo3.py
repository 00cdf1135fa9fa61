"""The configuration files train through rl_zoo3 as they are."""

import pytest

from tests.agents.commands import FORWARD, REACH, ROOT, run

pytest.importorskip("rl_zoo3")


@pytest.mark.parametrize(
    ("algo", "env_id", "small"),
    [
        ("ppo", FORWARD, ("n_steps:20", "batch_size:20")),
        ("sac", REACH, ("learning_starts:10", "gradient_steps:1")),
    ],
)
def test_rl_zoo3_trains_from_the_same_file(tmp_path, algo, env_id, small):
    run("rl_zoo3.train", "--algo", algo, "--env", env_id, "--gym-packages", "elastica_gym", "--conf-file",
        ROOT / "configs" / f"{algo}.yml", "-n", 40, "--eval-freq", -1, "--num-threads", 1, "--seed", 1, "-f", tmp_path,
        "-params", "n_envs:2", *small, "--env-kwargs", "duration:0.5")  # fmt: skip
    assert len(list((tmp_path / algo).rglob("*.zip"))) == 1
