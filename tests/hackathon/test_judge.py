"""The judge end to end: policies in a separate process, samples of real physics, points."""

import json
import subprocess
import sys
from pathlib import Path

import gymnasium
import numpy as np
import pytest
import yaml
from gymnasium.vector import AutoresetMode
from stable_baselines3 import PPO
from stable_baselines3.common.vec_env import VecNormalize

from elastica_gym.console.bad_input import BadInputError
from elastica_gym.hackathon.judge import judge
from elastica_gym.hackathon.policy_process import PolicyError, PolicyProcess
from elastica_gym.hackathon.scoring import GOALS, goals_held, grabbed, moved
from elastica_gym.hackathon.trials import SAMPLE_TIME, run_trials
from elastica_gym.rl import policies
from elastica_gym.rl.seeds import SCORED, TEST, TRAINED, VALIDATION, target_seeds
from elastica_gym.rl.vec_env import make_batch_vec_env
from elastica_gym.scripted import scripted_policy
from tests.agents.commands import ROOT, environment

REACH = "elastica_gym/OctopusReach-v1"
FETCH = "elastica_gym/OctopusFetch-v1"
SHORT = dict(targets=1, target_seed=3, duration=0.3)
SHAPE = (3, 42)


@pytest.fixture
def write(tmp_path):
    """Write a policy file and return its path."""

    def file(text, name="policy.py"):
        path = tmp_path / name
        path.write_text(text)
        return path

    return file


ZERO = "import numpy as np\n\ndef policy(observation):\n    return np.zeros(42)\n"
RANDOM = (
    "import numpy as np\n\nrng = np.random.default_rng(0)\n\n"
    "def policy(observation):\n    return rng.uniform(-1.0, 1.0, 42)\n"
)


def look_on(*_):
    pass


# input and output of the policy


def test_a_file_gets_observations_and_has_a_memory_per_episode(write):
    path = write(
        "import numpy as np\n\ncalls = 0\n\ndef reset():\n    global calls\n    calls = 10\n\n"
        "def policy(observation):\n    global calls\n    calls += 1\n"
        "    assert observation.shape == (5,)\n"
        "    return np.full(42, 0.01 * calls) * observation[0]\n"
    )
    with PolicyProcess(path) as policy:
        for _ in range(2):
            policy.begin(3)
            observations = np.arange(15.0, dtype=np.float32).reshape(3, 5)
            for calls in (11, 12):
                actions = policy(observations, SHAPE)
                np.testing.assert_allclose(actions, np.outer([0.0, 5.0, 10.0], np.full(42, 0.01 * calls)), rtol=1e-6)


@pytest.mark.parametrize(
    ("body", "message"),
    [
        ("return np.zeros(41)", r"actions of shape \(3, 41\), not \(3, 42\)"),
        ("return 0.0", r"actions of shape \(3,\), not \(3, 42\)"),
        ("return np.full(42, np.nan)", "not finite"),
        ("return np.full(42, np.inf)", "not finite"),
        ("raise RuntimeError('oh')", r"\.py, line 4: RuntimeError: oh"),
        ("return 'left'", r"\.py: ValueError: could not convert string"),
        ("return None", "not finite|shape"),
        ("import os; os._exit(0)", r"has ended \(status 0\)"),
        ("import os, signal; os.kill(os.getpid(), signal.SIGSEGV)", "has ended"),
        ("import time; time.sleep(60)", "took more than 1 s for its actions"),
    ],
)
def test_a_policy_that_fails(write, body, message):
    path = write(f"import numpy as np\n\ndef policy(observation):\n    {body}\n")
    with PolicyProcess(path, acting_time=1.0) as policy:
        policy.begin(3)
        with pytest.raises(PolicyError, match=message):
            policy(np.zeros((3, 5), np.float32), SHAPE)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("import nothing_of_that_name\n", "line 1: ModuleNotFoundError: No module named 'nothing_of_that_name'"),
        ("x = 1\n", "has no function policy"),
        ("x = 1\ndef policy(\n", "line 2: SyntaxError"),
        ("policy = 3\n", "has no function policy"),
    ],
)
def test_a_file_that_is_not_a_policy(write, text, message):
    with PolicyProcess(write(text)) as policy, pytest.raises(PolicyError, match=message):
        policy.begin(1)


def test_a_file_may_print(write):
    path = write("print('hello')\n" + ZERO.replace("return", "print('there')\n    return"))
    with PolicyProcess(path) as policy:
        policy.begin(1)
        np.testing.assert_array_equal(policy(np.zeros((1, 5), np.float32), (1, 42)), np.zeros((1, 42)))


def test_pickled_objects_are_not_read(write):
    """A policy that writes a pickled array directly into the pipe."""
    path = write(
        "import gc, io\nfrom multiprocessing.connection import Connection\nimport numpy as np\n\n"
        "def policy(observation):\n"
        "    file = io.BytesIO()\n    np.save(file, np.array([print], dtype=object), allow_pickle=True)\n"
        "    [c for c in gc.get_objects() if isinstance(c, Connection)][0].send_bytes(file.getvalue())\n"
        "    return np.zeros(42)\n"
    )
    with PolicyProcess(path) as policy:
        policy.begin(1)
        with pytest.raises(PolicyError, match="did not return an array"):
            policy(np.zeros((1, 5), np.float32), (1, 42))


def test_no_policy():
    with pytest.raises(BadInputError, match=r"There is no policy nowhere.py"):
        PolicyProcess(Path("nowhere.py"))


@pytest.fixture(scope="module")
def trained(tmp_path_factory):
    """The folder of a run with an untrained network and statistics."""
    folder = tmp_path_factory.mktemp("run")
    env = VecNormalize(make_batch_vec_env(REACH, n_envs=4))
    env.seed(0)
    env.reset()
    for _ in range(5):
        env.step(np.zeros((4, 42), np.float32))
    PPO("MlpPolicy", env, seed=0, device="cpu").save(folder / "model.zip")
    env.save(folder / "vecnormalize.pkl")
    config = {"env": REACH, "algo": "ppo", "seed": 0, "hyperparameters": {"normalize": True}}
    (folder / "config.yml").write_text(yaml.safe_dump(config))
    env.close()
    return folder


def test_a_run_acts_as_in_this_process(trained):
    observations = np.random.default_rng(0).normal(size=(3, 210)).astype(np.float32)
    with PolicyProcess(trained / "model.zip") as policy:
        policy.begin(3)
        np.testing.assert_array_equal(policy(observations, SHAPE), policies.load_run(trained)[0](observations, None))


def test_a_run_without_its_files(tmp_path):
    (tmp_path / "model.zip").write_bytes(b"nothing")
    with PolicyProcess(tmp_path / "model.zip") as policy, pytest.raises(PolicyError, match="not the folder of a run"):
        policy.begin(1)


# samples of the physics


def reach(n=2, **kwargs):
    return gymnasium.make_vec(REACH, num_envs=n, autoreset_mode=AutoresetMode.DISABLED, **kwargs).unwrapped


def test_targets_are_never_those_of_training():
    seeds = [seed for stream in range(3) for seed in target_seeds(2020, stream, 100)]
    assert len(set(seeds)) == 300 and min(seeds) >= SCORED > 2 * TRAINED - 1 > max(*VALIDATION[-1:], *TEST[-1:])
    assert target_seeds(2020, 1, 5) == target_seeds(2020, 1, 100)[:5] != target_seeds(2021, 1, 5)


@pytest.mark.parametrize("control_dt", [0.05, 0.013, 0.005])
def test_sampling_changes_nothing(control_dt):
    rng = np.random.default_rng(0)
    seeds, seen = [5, 6, 7], []
    actions = [rng.uniform(-1.0, 1.0, (3, 42)).astype(np.float32) for _ in range(round(0.3 / control_dt))]
    played = iter(actions)

    def watch(batch, sampler, infos):
        seen.append((batch.state.x.copy(), batch.state.body_x.copy()))

    kwargs = dict(duration=0.3, control_dt=control_dt, spread="default")
    samples = run_trials(lambda *_: next(played), REACH, seeds=seeds, watch=watch, n_threads=2, **kwargs)
    env = reach(3, **kwargs)
    env.reset(seed=seeds)
    for action, (x, body_x) in zip(actions, seen[1:], strict=True):
        env.step(action)
        np.testing.assert_array_equal(env.state.x, x)
        np.testing.assert_array_equal(env.state.body_x, body_x)
    gaps = np.diff(samples.time)
    assert gaps.min() > 0.0 and gaps.max() <= SAMPLE_TIME + 1e-12
    assert samples.time[-1] == pytest.approx(control_dt * len(actions))
    # samples within a step follow the same motion: no jumps, and the ends match the batch
    assert np.abs(np.diff(samples.head, axis=0)).max() < 0.05
    np.testing.assert_array_equal(samples.head[-1], env.state.x[:, [0, 2], env.body.sensors.head])
    assert samples.counted.all()


def test_samples_within_a_step_match_the_physics():
    """Control steps of one sample each give the same samples up to rounding, which friction amplifies."""
    actions = np.random.default_rng(1).uniform(-1.0, 1.0, (1, 42)).astype(np.float32)

    def run(control_dt):
        kwargs = dict(duration=0.05, control_dt=control_dt, sim_dt=1e-4, spread="default")
        return run_trials(lambda *_: actions, REACH, seeds=[5], watch=look_on, **kwargs)

    for coarse, fine in zip(run(0.05), run(0.01), strict=True):
        np.testing.assert_allclose(coarse, fine, rtol=1e-5, atol=1e-5)


def test_an_episode_depends_on_its_seed_alone(write):
    path, episodes = write(RANDOM), []
    for seeds, n_threads in (([5, 6, 7], 2), ([5, 6, 7], 1), ([6], 2)):
        with PolicyProcess(path) as policy:
            policy.begin(len(seeds))
            episodes.append(run_trials(policy, REACH, seeds=seeds, watch=look_on, duration=0.2, n_threads=n_threads))
    for together, on_one_thread, alone in zip(*episodes, strict=True):
        np.testing.assert_array_equal(together, on_one_thread)
        if together.ndim > 1:
            np.testing.assert_array_equal(together[:, 1], alone[:, 0])


def test_an_episode_is_over_when_the_animal_has_toppled():
    def topple(batch, sampler, infos):
        if batch.elapsed[0] == 1:
            # about its own axis, rolling like a ball
            batch.state.w[1, 2] = 50.0
            batch.state.v[1, 1] = 1.0

    samples = run_trials(lambda *_: np.zeros((2, 42)), REACH, seeds=[1, 2], watch=topple, duration=0.5)
    assert samples.counted[:, 0].all()
    counted = samples.counted[:, 1]
    assert counted[0] and not counted[-1] and (np.diff(counted.astype(int)) <= 0).all()


def test_divergence_ends_an_episode():
    def break_one(batch, sampler, infos):
        if batch.elapsed[0] == 2:
            batch.state.x[0, :, 40] = np.nan

    samples = run_trials(lambda *_: np.zeros((2, 42)), REACH, seeds=[1, 2], watch=break_one, duration=0.3)
    assert not samples.counted[-1, 0] and samples.counted[:, 1].all()
    assert samples.counted[:10, 0].all()


def test_an_object_that_flies_by_itself_was_not_moved():
    def push(batch, sampler, infos):
        batch.state.body_v[:, 0, 0] = 1.0

    samples = run_trials(lambda *_: np.zeros((2, 42)), REACH, seeds=[1, 2], watch=push, spread="default", duration=0.5)
    assert (np.linalg.norm(samples.base[-1] - samples.base[0], axis=1) > 0.15).all()
    assert not moved(samples)[-1].any()


def beside_the_second_arm(batch, sampler, infos):
    """Place the upright object where the second arm will close around it."""
    if infos is None:
        body, state, k = batch.body, batch.state, int(batch.body.model.first_slot[0]) + 86
        for i in range(batch.num_envs):
            x = state.x[i]
            beside = np.cross(x[:, k + 1] - x[:, k], [0.0, 1.0, 0.0])
            beside *= (state.radius[i, k] + body.cylinders[0].radius + 0.003) / np.linalg.norm(beside)
            state.body_x[i, 0, [0, 2]] = (0.5 * (x[:, k] + x[:, k + 1]) + beside)[[0, 2]]


def test_an_arm_that_holds_the_object_has_grabbed_it():
    actions = np.zeros((2, 42))
    # full bending of the second arm, in one environment
    actions[0, 7:14] = 1.0
    samples = run_trials(
        lambda *_: actions, REACH, seeds=[1, 2], watch=beside_the_second_arm, spread="default", duration=2.5
    )
    assert grabbed(samples)[-1].tolist() == [True, False]
    assert samples.spans[-1, 0].argmax() == 1 and np.degrees(samples.spans[-1, 0, 1]) > 200.0
    assert samples.touched[-1, 0] and (samples.tilt[:, 0] < np.radians(30.0)).all()


# points


@pytest.mark.parametrize("text", [ZERO, RANDOM])
def test_zero_and_random_score_nothing(write, text):
    result = judge(write(text), REACH, targets=2, target_seed=2020, duration=2.0)
    assert result["total"] == 0.0 and result["error"] == ""
    assert [result[goal] for goal in (*GOALS, "general")] == [0.0] * 6


@pytest.mark.slow
@pytest.mark.parametrize("text", [ZERO, RANDOM])
def test_zero_and_random_score_nothing_in_whole_episodes(write, text):
    result = judge(write(text), FETCH, targets=10, target_seed=2020)
    assert result["total"] == 0.0 and result["error"] == ""


@pytest.mark.slow
def test_all_goals_can_be_achieved():
    """By a script with access to the whole state, in some of ten episodes."""
    seen = {}

    def watch(batch, sampler, infos):
        seen["batch"] = batch

    def script(observations, shape):
        return scripted_policy(seen["batch"].task)(seen["batch"])

    samples = run_trials(script, FETCH, seeds=target_seeds(2020, 0, 10), watch=watch, spread="default")
    assert goals_held(samples)[-1].any()


def test_a_policy_that_fails_late_scores_nothing(write):
    path = write(
        ZERO.replace("import", "calls = 0\nimport").replace(
            "    return", "    global calls\n    calls += 1\n    assert calls < 4\n    return"
        )
    )
    result = judge(path, REACH, **SHORT)
    assert result["total"] == 0.0 and "line 7: AssertionError" in result["error"]


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        (dict(env_id="elastica_gym/OctopusRech-v1"), "did you mean 'elastica_gym/OctopusReach-v1'"),
        (dict(env_id="elastica_gym/SnakeReach-v1"), "has no object to fetch"),
        (dict(env_id="elastica_gym/OctopusCrawl-v1"), "has no object to fetch"),
        (dict(targets=0), "targets must be from 1 to 1000, got 0"),
        (dict(target_seed=-1), "target_seed must be at least 0, got -1"),
        (dict(n_threads=0), "threads must be at least 1, got 0"),
        (dict(n_threads=5000), "threads must be at most 4096, got 5000"),
    ],
)
def test_bad_arguments_are_refused(write, changed, message):
    with pytest.raises(BadInputError, match=message):
        judge(**{"path": write(ZERO), "env_id": REACH, "targets": 1, "target_seed": 0, **changed})


def score_command(*args):
    command = [sys.executable, str(ROOT / "scripts" / "score.py"), *map(str, args)]
    return subprocess.run(command, env=environment(), cwd=ROOT, capture_output=True, text=True, timeout=400)


def test_the_command(write, tmp_path):
    out, recordings = tmp_path / "out" / "score.json", tmp_path / "recordings"
    # the policy fails after three steps
    path = write(
        ZERO.replace("def policy", "calls = 0\n\ndef policy").replace(
            "    return", "    global calls\n    calls += 1\n    assert calls < 4, 'enough'\n    return"
        )
    )
    done = score_command("--policy", path, "--env", REACH, "--targets", 1, "--json", out, "--record", recordings)
    assert done.returncode == 1, done.stderr
    assert f"No points: {path}, line" in done.stdout and "AssertionError: enough" in done.stdout
    assert "Traceback" not in done.stderr
    result = json.loads(out.read_text())
    assert result["total"] == 0.0 and set(GOALS) | {"general"} <= set(result)
    assert len(list(recordings.glob("*.rrd"))) == 1
    missing = score_command("--policy", tmp_path / "nothing.py", "--env", REACH)
    assert missing.returncode == 2 and "error: There is no policy" in missing.stderr
    assert "Traceback" not in missing.stderr
