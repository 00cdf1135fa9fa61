"""PPO of skrl on the native batch: ``python scripts/examples/engines/skrl_ppo.py``.

skrl's wrapper takes the batch as it is, with the default autoreset (NEXT_STEP): the observation after a truncated
episode is its last, from which skrl bootstraps. The step that only resets stays in its memory, as one with reward zero.
"""

import argparse

import gymnasium
import numpy as np
from gymnasium.wrappers.vector import RecordEpisodeStatistics
from skrl.agents.torch.ppo import PPO, PPO_CFG
from skrl.envs.wrappers.torch import wrap_env
from skrl.memories.torch import RandomMemory
from skrl.resources.preprocessors.torch import RunningStandardScaler
from skrl.trainers.torch import StepTrainer
from skrl.utils import set_seed
from skrl.utils.model_instantiators.torch import deterministic_model, gaussian_model

import elastica_gym  # noqa: F401  registers the environments

ROLLOUT = 40


def main() -> None:
    """Train a snake with skrl's own trainer."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--env", default="elastica_gym/SnakeForward-v1")
    parser.add_argument("--steps", type=int, default=300_000)
    parser.add_argument("--num-envs", type=int, default=64)
    parser.add_argument("--seed", type=int, default=0)
    a = parser.parse_args()
    set_seed(a.seed)
    envs = RecordEpisodeStatistics(gymnasium.make_vec(a.env, num_envs=a.num_envs))
    env = wrap_env(envs, verbose=False)
    cfg = PPO_CFG(
        rollouts=ROLLOUT,
        mini_batches=8,
        discount_factor=0.98,
        gae_lambda=0.92,
        learning_rate=1e-3,
        time_limit_bootstrap=True,
        observation_preprocessor=RunningStandardScaler,
        observation_preprocessor_kwargs={"size": env.observation_space},
        rewards_shaper=lambda rewards, *_: 10.0 * rewards,
        experiment={"write_interval": 0, "checkpoint_interval": 0},
    )
    spaces = {"observation_space": env.observation_space, "action_space": env.action_space}
    layers = [{"name": "net", "input": "OBSERVATIONS", "layers": [128, 128], "activations": "tanh"}]
    policy = gaussian_model(**spaces, network=layers, output="ACTIONS", initial_log_std=-1.0)
    value = deterministic_model(**spaces, network=layers, output="ONE")
    memory = RandomMemory(memory_size=ROLLOUT, num_envs=a.num_envs)
    agent = PPO(models={"policy": policy, "value": value}, memory=memory, cfg=cfg, **spaces)
    n = a.steps // a.num_envs
    trainer = StepTrainer(env=env, agents=agent, cfg={"timesteps": n, "disable_progressbar": True, "headless": True})
    for t in range(1, n + 1):
        trainer.train()
        if t % ROLLOUT == 0 and envs.return_queue:
            print(f"steps {t * a.num_envs:>8,}  return {np.mean(envs.return_queue):8.3f}", flush=True)
    envs.close()


if __name__ == "__main__":
    main()
