"""PPO of TorchRL on the native batch: ``python scripts/examples/engines/torchrl_ppo.py``.

TorchRL resets environments by itself: the batch is made with AutoresetMode.DISABLED, and gets their mask.
"""

import argparse

import gymnasium
import torch
from gymnasium.vector import AutoresetMode
from tensordict.nn import AddStateIndependentNormalScale, TensorDictModule
from torch import nn
from torchrl.collectors import Collector
from torchrl.envs import Compose, DoubleToFloat, GymWrapper, RewardScaling, RewardSum, TransformedEnv, VecNormV2
from torchrl.modules import MLP, IndependentNormal, ProbabilisticActor, ValueOperator
from torchrl.objectives import ClipPPOLoss
from torchrl.objectives.value import GAE

import elastica_gym  # noqa: F401  registers the environments

ROLLOUT, EPOCHS, MINIBATCHES = 40, 8, 8


def main() -> None:
    """Train a snake with TorchRL's collector, advantages and loss."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--env", default="elastica_gym/SnakeForward-v1")
    parser.add_argument("--steps", type=int, default=300_000)
    parser.add_argument("--num-envs", type=int, default=64)
    parser.add_argument("--seed", type=int, default=0)
    a = parser.parse_args()
    torch.manual_seed(a.seed)
    batch = gymnasium.make_vec(a.env, num_envs=a.num_envs, autoreset_mode=AutoresetMode.DISABLED)
    norm = VecNormV2(in_keys=["observation"], out_keys=["scaled"])
    env = TransformedEnv(GymWrapper(batch), Compose(DoubleToFloat(), RewardSum(), RewardScaling(0.0, 10.0), norm))
    env.set_seed(a.seed)
    n, m = batch.single_observation_space.shape[0], batch.single_action_space.shape[0]
    hidden = dict(num_cells=[128, 128], activation_class=nn.Tanh)
    mean = MLP(n, m, **hidden)
    mean[-1].weight.data *= 0.01
    scale = AddStateIndependentNormalScale(m, scale_mapping="exp", scale_lb=1e-4)
    scale.state_independent_scale.data.fill_(-1.0)
    actor = ProbabilisticActor(
        TensorDictModule(nn.Sequential(mean, scale), in_keys=["scaled"], out_keys=["loc", "scale"]),
        in_keys=["loc", "scale"],
        distribution_class=IndependentNormal,
        return_log_prob=True,
    )
    value = MLP(n, 1, **hidden)
    value[-1].weight.data *= 0.01
    critic = ValueOperator(value, in_keys=["scaled"])
    advantages = GAE(gamma=0.98, lmbda=0.92, value_network=critic)
    loss = ClipPPOLoss(actor, critic, normalize_advantage=True, entropy_bonus=False)
    optimizer = torch.optim.Adam(loss.parameters(), lr=1e-3)
    size = ROLLOUT * a.num_envs
    collector = Collector(env, actor, frames_per_batch=size, total_frames=a.steps // size * size)
    for i, data in enumerate(collector, 1):
        for _ in range(EPOCHS):
            with torch.no_grad():
                advantages(data)
            rows = data.reshape(-1)
            for part in torch.randperm(size).chunk(MINIBATCHES):
                losses = loss(rows[part])
                optimizer.zero_grad()
                (losses["loss_objective"] + losses["loss_critic"]).backward()
                nn.utils.clip_grad_norm_(loss.parameters(), 0.5)
                optimizer.step()
        ended = data["next", "done"]
        if ended.any():
            print(f"steps {i * size:>8,}  return {data['next', 'episode_reward'][ended].mean():8.3f}", flush=True)
    collector.shutdown()


if __name__ == "__main__":
    main()
