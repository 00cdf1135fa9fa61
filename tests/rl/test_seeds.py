import numpy as np
import pytest

from elastica_gym.commands.train import TrainArguments, _started
from elastica_gym.rl.seeds import RUNS, SCORED, TEST, TRAINED, VALIDATION, target_seeds, training_seeds
from elastica_gym.rl.training import Training


def test_runs_share_no_seeds_with_each_other_or_with_evaluations():
    runs = [training_seeds(seed, 0, 256) for seed in (*range(200), RUNS[-1])]
    drawn = {each for seeds in runs for each in seeds}
    assert len(drawn) == 256 * len(runs)
    assert min(drawn) >= TRAINED > max(VALIDATION[-1], TEST[-1]) and max(drawn) < SCORED
    assert drawn.isdisjoint(target_seeds(2020, 0, 1000))


def test_seeds_do_not_depend_on_how_many_are_drawn():
    assert training_seeds(3, 5, 7) == training_seeds(3, 0, 40)[5:12]


@pytest.mark.parametrize("algo", ["ppo", "sac"])
def test_environments_of_different_runs_have_different_generators(algo, tmp_path):
    starts = []
    for seed in (0, 1):
        arguments = TrainArguments(algo=algo, seed=seed, n_envs=4, steps=1, folder=tmp_path / f"{algo}-{seed}")
        training = Training(*_started(arguments), resume=False)
        starts.append(training.model.get_env().reset())
        assert training.adapter.batch.np_random_seed == tuple(training_seeds(seed, 0, 4))
        training.adapter.close()
    first, second = starts
    distances = np.abs(first[:, None] - second[None]).max(axis=2)
    assert (distances > 0.0).all()
