"""Print digests of the results of environments, library and training, to compare two versions on one machine.

A change that preserves behaviour preserves every digest:

    python scripts/digests.py --out before.json
    python scripts/digests.py --compare before.json

Digests depend on the machine, as compiled kernels do.
"""

import dataclasses
import hashlib
import itertools
import json
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path

import gymnasium
import numpy as np

import elastica_gym.cosserat as ea
from elastica_gym.console.bad_input import BadInputError, require_extra, run_command
from elastica_gym.envs import GOAL_IDS, IDS

SEEDS = (0, 1, 2)
STEPS = 50
"""Control steps of an environment under random actions"""
SCENES = 30
X, Y, Z = np.eye(3)


@dataclasses.dataclass
class Arguments:
    """Digest environments, scenes of the library, a training and the shipped policies."""

    out: Path | None = None
    """File for the digests, as JSON."""
    compare: Path | None = None
    """File of digests to compare with; the command fails if any differs."""
    parts: tuple[str, ...] = ("environments", "library", "training", "policies")
    """Parts to digest."""


class Digest:
    """A digest of the bits of numbers."""

    def __init__(self) -> None:
        self._hash = hashlib.sha256()

    def add(self, *values: object) -> None:
        """Add arrays or array-likes."""
        for value in values:
            if isinstance(value, dict):
                self.add(*(value[key] for key in sorted(value)))
            else:
                self._hash.update(np.ascontiguousarray(value).tobytes())

    def __str__(self) -> str:
        return self._hash.hexdigest()[:16]


def environments() -> Iterator[tuple[str, Callable[[], str]]]:
    """Yield names and digests of every environment id, single and in a batch."""
    for env_id in (*IDS, *GOAL_IDS):
        name = env_id.partition("/")[2]
        yield f"{name}, single", lambda env_id=env_id: _environment(env_id, batch=False)
        yield f"{name}, batch", lambda env_id=env_id: _environment(env_id, batch=True)


def _environment(env_id: str, *, batch: bool) -> str:
    digest = Digest()
    env = gymnasium.make_vec(env_id, num_envs=3, n_threads=1) if batch else gymnasium.make(env_id)
    for seed in SEEDS:
        env.action_space.seed(seed)
        digest.add(env.reset(seed=seed)[0])
        for _ in range(STEPS):
            observation, reward, terminated, truncated, _ = env.step(env.action_space.sample())
            digest.add(observation, reward, terminated, truncated)
            if not batch and (terminated or truncated):
                digest.add(env.reset()[0])
    env.close()
    return str(digest)


class Simulator(
    ea.BaseSystemCollection, ea.Constraints, ea.Forcing, ea.Connections, ea.CallBacks, ea.Damping, ea.Contact
):
    """A simulator with every feature of the library."""


def library() -> Iterator[tuple[str, Callable[[], str]]]:
    """Yield names and digests of scenes of the library."""
    for number in range(SCENES):
        yield f"scene {number}", lambda number=number: _scene(number)


def _scene(number: int) -> str:
    """Digest one to three rods with random features, seeded by the scene's number."""
    rng, sim, rods, dt = np.random.default_rng(number), Simulator(), [], 2.0**-16
    for place in range(1 + number % 3):
        rod = ea.CosseratRod.straight_rod(
            int(rng.integers(8, 30)),
            np.array([0.0, 0.3 + 0.022 * place, 0.0]),
            X if place % 2 else Z,
            Y,
            0.3,
            0.01,
            1000.0,
            youngs_modulus=1e5,
            shear_modulus=4e4,
        )
        rod.velocity_collection[:] = 0.1 * rng.standard_normal(rod.velocity_collection.shape)
        sim.append(rod)
        rods.append(rod)
    for rod in rods:
        _add_features(sim, rod, rng, dt)
    plane = ea.Plane(np.zeros(3), Y)
    sim.append(plane)
    for rod in rods:
        if rng.random() < 0.5:
            sim.detect_contact_between(rod, plane).using(ea.RodPlaneContact, k=10.0, nu=0.01)
    for one, two in itertools.pairwise(rods):
        if rng.random() < 0.5:
            joint = (ea.FreeJoint, ea.FixedJoint)[int(rng.integers(2))]
            more = dict(kt=0.01, nut=0.0) if joint is ea.FixedJoint else {}
            sim.connect(one, two, 0, 0).using(joint, k=100.0, nu=0.1, **more)
        else:
            sim.detect_contact_between(one, two).using(ea.RodRodContact, k=100.0, nu=0.01)
    if number % 5 == 0:
        ball = ea.Sphere(np.array([0.1, 0.35, 0.1]), 0.03, 1000.0)
        sim.append(ball)
        sim.add_forcing_to(ball).using(ea.GravityForces, -9.81 * Y)
        sim.detect_contact_between(rods[0], ball).using(ea.RodSphereContact, k=50.0, nu=0.01)
    sim.finalize()
    ea.integrate(ea.PositionVerlet(), sim, 2000 * dt, 2000, progress_bar=False)
    digest = Digest()
    for rod in rods:
        digest.add(rod.position_collection, rod.director_collection, rod.velocity_collection, rod.omega_collection)
        digest.add(rod.internal_forces, rod.internal_torques)
    return str(digest)


def _add_features(sim: Simulator, rod: ea.CosseratRod, rng: np.random.Generator, dt: float) -> None:
    """Randomly add forces, a constraint and damping to a rod."""
    if rng.random() < 0.6:
        sim.add_forcing_to(rod).using(ea.GravityForces, -9.81 * Y)
    if rng.random() < 0.4:
        sim.add_forcing_to(rod).using(ea.EndpointForces, 0.01 * X, -0.02 * Z, 0.01)
    if rng.random() < 0.4:
        sim.add_forcing_to(rod).using(ea.UniformTorques, 1e-3, Y)
    if rng.random() < 0.4:
        sim.add_forcing_to(rod).using(
            ea.MuscleTorques,
            base_length=0.3,
            b_coeff=rng.uniform(0.0, 0.01, 4),
            period=0.5,
            wave_number=10.0,
            phase_shift=0.0,
            direction=Y,
            rest_lengths=rod.rest_lengths,
            ramp_up_time=0.1,
        )
    if rng.random() < 0.5:
        sim.constrain(rod).using(ea.OneEndFixedBC, constrained_position_idx=(0,), constrained_director_idx=(0,))
    kind = int(rng.integers(4))
    if kind == 1:
        sim.dampen(rod).using(ea.AnalyticalLinearDamper, damping_constant=0.5, time_step=dt)
    elif kind == 2:
        sim.dampen(rod).using(ea.AnalyticalLinearDamper, uniform_damping_constant=2.0, time_step=dt)
    elif kind == 3:
        sim.dampen(rod).using(ea.LaplaceDissipationFilter, filter_order=3)


def training() -> Iterator[tuple[str, Callable[[], str]]]:
    """Yield the digest of a short training by PPO."""
    yield "PPO, 8,192 steps", _training


def _training() -> str:
    import torch

    with tempfile.TemporaryDirectory() as folder:
        subprocess.run(
            [
                sys.executable,
                "-m",
                "agents.train",
                "--env",
                IDS[0],
                "--steps",
                "8192",
                "--threads",
                "1",
                "--evaluations",
                "1",
                "--evaluation-episodes",
                "2",
                "--recordings",
                "0",
                "--folder",
                f"{folder}/run",
            ],
            check=True,
            stdout=subprocess.DEVNULL,
        )
        from stable_baselines3 import PPO

        model = PPO.load(f"{folder}/run/model.zip", device="cpu")
    digest = Digest()
    with torch.no_grad():
        for _, tensor in sorted(model.policy.state_dict().items()):
            digest.add(tensor.numpy())
    return str(digest)


def policies() -> Iterator[tuple[str, Callable[[], str]]]:
    """Yield names and digests of the episodes of every shipped policy."""
    from elastica_gym.rl.cards import names

    for name in names():
        yield name, lambda name=name: _policy(name)


def _policy(name: str) -> str:
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder, "scores.json")
        subprocess.run(
            [
                sys.executable,
                "-m",
                "agents.evaluate",
                "--pretrained",
                name,
                "--episodes",
                "4",
                "--seed",
                "2000000",
                "--threads",
                "1",
                "--json",
                str(out),
            ],
            check=True,
            stdout=subprocess.DEVNULL,
        )
        found = json.loads(out.read_text())
    return hashlib.sha256(json.dumps(found["per_episode"], sort_keys=True).encode()).hexdigest()[:16]


PARTS = {"environments": environments, "library": library, "training": training, "policies": policies}


def main() -> None:
    """Run the command line."""
    require_extra("train")
    import tyro

    from elastica_gym.progress import track

    arguments = tyro.cli(Arguments)
    found = {}
    for part in arguments.parts:
        for name, digest in track(list(PARTS[part]()), part):
            found[f"{part}: {name}"] = digest()
    if arguments.out is not None:
        arguments.out.write_text(json.dumps(found, indent=2) + "\n")
        print(f"wrote {len(found)} digests to {arguments.out}")
    if arguments.compare is not None:
        before = json.loads(arguments.compare.read_text())
        changed = [name for name in found if before.get(name) != found[name]]
        if changed:
            raise BadInputError("digests differ: " + "; ".join(changed))
        print(f"all {len(found)} digests agree with {arguments.compare}")
    if arguments.out is None and arguments.compare is None:
        for name, value in found.items():
            print(f"{value}  {name}")


if __name__ == "__main__":
    run_command(main)
