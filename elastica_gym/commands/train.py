"""Train an agent: ``python -m agents.train --env elastica_gym/SnakeForward-v1 --algo ppo``."""

import dataclasses
import importlib.util
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..console.bad_input import (
    BadInputError,
    check_bounds,
    choose,
    choose_environment,
    fail,
    make_folder,
    missing_extra,
    require_extra,
)
from ..rl.run_files import BEST
from ..rl.seeds import RUNS, VALIDATION, check_seeds
from . import invocation, parse

if TYPE_CHECKING:
    from ..rl.rllib_engine import RllibTraining
    from ..rl.training import Training
    from ..viz.viewer import LiveView


ENGINES = ("sb3", "rllib")


@dataclasses.dataclass
class TrainArguments:
    """Train an agent with Stable-Baselines3, or with RLlib on several processes.

    Hyperparameters come from configs/<algo>.yml. Results are written to runs/<id>/<algo>-<seed>-<time>/.
    """

    env: str = "elastica_gym/SnakeForward-v1"
    """Environment id, optionally with the module that registers it, as in my_module:my_lab/SnakeTurn-v0."""
    algo: str = "ppo"
    """Algorithm: ppo or sac."""
    engine: str = "sb3"
    """Library: sb3, or rllib, whose PPO collects experience in several processes (docs/how_to/ray.md). rllib leaves
    out target_kl, symmetric policies and the normalisation of rewards."""
    seed: int = 0
    """Seed of networks and exploration, below 2**32; the environments' seeds are derived from it (`rl.seeds`)."""
    steps: int | None = None
    """Environment steps to train for, rounded up to whole updates (of PPO, n_envs times n_steps); by default
    n_timesteps of the configuration, or no limit if minutes are given."""
    minutes: float | None = None
    """Wall-clock budget of training and its evaluations; schedules follow its remaining fraction."""
    n_envs: int | None = None
    """Number of environments in the batch, instead of the configuration's."""
    set: list[str] = dataclasses.field(default_factory=list)
    """Hyperparameters that override the configuration's, as KEY=VALUE, such as learning_rate=0.0005 gamma=0.99."""
    config: Path | None = None
    """Another configuration file of the same format."""
    start_from: str | None = None
    """Folder of a run, or name of a pretrained policy, whose networks to start from; of the same algorithm, for example
    from an easier task of the same animal."""
    imitate: int = 0
    """Environment steps of imitating the task's scripted policy first; they count towards the minutes, but not towards
    `steps`, which may be 0."""
    threads: int = 2
    """Threads for the physics; results do not depend on them."""
    evaluations: int = 10
    """Number of evaluations after the one at the start, spread evenly over the budget; 0 for none at all."""
    evaluation_episodes: int = 20
    """Episodes per evaluation."""
    evaluation_seed: int = VALIDATION.start
    """Seed of an evaluation's first episode; separate from training and test seeds (`elastica_gym.rl.seeds`)."""
    recordings: int = 1
    """Evaluation episodes recorded for rerun at the end."""
    checkpoint_minutes: float = 1.0
    """Time between checkpoints; 0 writes one after every update."""
    env_runners: int = 1
    """Processes that collect experience with --engine rllib, one core each, besides the learner's."""
    address: str | None = None
    """Ray cluster for --engine rllib, as host:port of its head node, or auto on one of its nodes; by default the cores
    of this machine."""
    rerun: bool = False
    """Show evaluations, curves and reward terms in rerun's window while training continues."""
    rerun_web: bool = False
    """The same in a browser on this machine."""
    tensorboard: bool = False
    """Write event files for TensorBoard into the run's folder."""
    out: Path = Path("runs")
    """Folder of all runs."""
    folder: Path | None = None
    """Folder of this run, instead of one in `out` named after id, algorithm, seed and time."""
    resume: Path | None = None
    """Folder of a run to continue from its last intact checkpoint; of other options only steps and minutes apply."""


def main() -> None:
    """Run the command line."""
    arguments = parse(
        "train",
        TrainArguments,
        "--env elastica_gym/SnakeForward-v1 --minutes 5",
        "--env elastica_gym/SnakeReach-v1 --start-from snake_forward_ppo --steps 700000",
        "--env elastica_gym/OctopusGrab-v1 --imitate 128000 --steps 0",
        "--engine rllib --env-runners 4 --steps 700000",
        "--resume runs/SnakeForward-v1/RUN",
    )
    require_extra("train")
    if arguments.tensorboard and importlib.util.find_spec("tensorboard") is None:
        raise BadInputError("tensorboard is not installed: pip install tensorboard")
    from ..progress import Bar

    with Bar("starting"):
        folder, config = _resumed(arguments) if arguments.resume else _started(arguments)
        # torch takes seconds to import: check the arguments first
        import yaml

        from ..files import write_atomically

        try:
            training = _training(arguments, folder, config)
        except BadInputError:
            if not any(folder.iterdir()):
                folder.rmdir()
            raise
    # written after setup, so that refused arguments leave the folder free
    text = yaml.safe_dump(config, sort_keys=False)
    write_atomically(folder / "config.yml", lambda path: path.write_text(text))
    print(f"Training {config['algo']} on {config['env']}, seed {config['seed']}, into {folder}")
    live = None
    try:
        live = _live_view(arguments, folder)
        finished = training.run(live)
    except (OSError, KeyboardInterrupt) as error:
        what = (
            "interrupted" if isinstance(error, KeyboardInterrupt) else f"{error.strerror}: {error.filename or folder}"
        )
        kept = training.last_checkpoint
        hint = f". The checkpoint {kept} is intact; continue with: {_resume_command(folder)}" if kept else ""
        fail(what + hint, status=130 if what == "interrupted" else 1)
    finally:
        if live is not None:
            live.close()
    if not finished:
        print(f"Saved. Continue with: {_resume_command(folder)}")
        raise SystemExit(130)
    recorded = " and recordings" if config["recordings"] else ""
    print(f"Finished. Model, metrics.csv, learning_curve.png{recorded} are in {folder}")
    if (folder / BEST).exists():
        print(f"The model with the best evaluation is in {folder / BEST}")
    print(f"Evaluate it with: {invocation('evaluate')} --run {folder}")


def _training(arguments: TrainArguments, folder: Path, config: dict[str, Any]) -> "Training | RllibTraining":
    resume = arguments.resume is not None
    # runs of earlier versions have no engine
    if config.get("engine", "sb3") == "rllib":
        from ..rl.rllib_engine import RllibTraining

        return RllibTraining(folder, config, resume=resume, address=arguments.address)
    from ..rl.training import Training

    return Training(folder, config, resume=resume, tensorboard=arguments.tensorboard)


def _live_view(arguments: TrainArguments, folder: Path) -> "LiveView | None":
    """Open the viewer that was asked for; without one, training goes on unwatched."""
    if not (arguments.rerun or arguments.rerun_web):
        return None
    if message := missing_extra("viz"):
        print(f"No viewer: {message}")
        return None
    from ..viz.viewer import LiveView, has_display

    if arguments.rerun and not has_display():
        print("No viewer: there is no display to open a window on; --rerun-web shows the same in a browser.")
        return None
    live = LiveView(f"{folder.parent.name}/{folder.name}", web=arguments.rerun_web)
    print(f"Watch it: {live.address}")
    return live


def _resume_command(folder: Path) -> str:
    return f"{invocation('train')} --resume {folder}"


def _started(arguments: TrainArguments) -> tuple[Path, dict[str, Any]]:
    """Check the arguments of a new run, create its folder, and return it with the contents of its config.yml."""
    config = config_of(arguments)
    folder = arguments.folder or _new_folder(arguments)
    if (folder / "config.yml").exists():
        raise BadInputError(f"The folder {folder} already has a run: use another, or {_resume_command(folder)}")
    return make_folder(folder), config


def config_of(arguments: TrainArguments, *, overrides: dict[str, Any] | None = None) -> dict[str, Any]:
    """Check the arguments of a new run, and return the contents of its config.yml; `overrides` are as in `set`."""
    from ..rl import hyperparameters, machine

    choose_environment(arguments.env)
    overrides = {**hyperparameters.parse_overrides(arguments.set), **(overrides or {})}
    if arguments.n_envs is not None:
        overrides["n_envs"] = arguments.n_envs
    values = hyperparameters.load(arguments.algo, arguments.env, config=arguments.config, overrides=overrides)
    config = {
        **{key: value for key, value in dataclasses.asdict(arguments).items() if key not in _NOT_IN_CONFIG},
        "start_from": _start(arguments.start_from),
        "config": arguments.config and str(arguments.config),
        "steps": hyperparameters.timesteps(values) if arguments.steps is arguments.minutes is None else arguments.steps,
        "hyperparameters": values,
        **machine.describe(),
    }
    _check(config)
    if arguments.engine == "rllib":
        from ..rl import rllib_engine

        _check_rllib(arguments, config)
        config["hyperparameters"] = rllib_engine.own_hyperparameters(values)
    return config


def _check_rllib(arguments: TrainArguments, config: dict[str, Any]) -> None:
    """Raise ``BadInputError`` for what RLlib does not do, and print the hyperparameters that it does not follow."""
    from ..rl.cluster import require_ray
    from ..rl.rllib_engine import layers, left_out

    if config["algo"] != "ppo":
        raise BadInputError(f"--engine rllib trains with ppo only, got --algo {config['algo']}")
    for name in ("imitate", "start_from", "minutes", "rerun", "rerun_web", "tensorboard"):
        if value := getattr(arguments, name):
            raise BadInputError(f"--engine rllib does not support --{name.replace('_', '-')}, got {value}")
    layers(config["hyperparameters"])
    require_ray("ray", "ray.rllib")
    print(f"RLlib leaves out {', '.join(left_out(config['hyperparameters'])) or 'nothing'}.")


def _start(start: str | None) -> str | None:
    """Return the name of a pretrained policy unchanged, and a run as its absolute path."""
    from ..rl.cards import names

    if start is None or start in names():
        return start
    if not Path(start).is_dir():
        raise BadInputError(
            f"--start-from {start} is neither the folder of a run nor a pretrained policy. "
            f"Pretrained policies: {', '.join(names())}"
        )
    return str(Path(start).resolve())


_NOT_IN_CONFIG = {"address", "set", "n_envs", "out", "folder", "resume", "rerun", "rerun_web", "tensorboard"}


def _resumed(arguments: TrainArguments) -> tuple[Path, dict[str, Any]]:
    """Read the config.yml of a run, with the budget of the arguments, if given."""
    from ..rl import hyperparameters
    from ..rl.policies import read_config

    assert arguments.resume is not None
    config = read_config(arguments.resume)
    # checked again, since the file may have been edited
    config["hyperparameters"] = hyperparameters.checked(config["algo"], config["hyperparameters"])
    if arguments.steps is not None or arguments.minutes is not None:
        config |= {"steps": arguments.steps, "minutes": arguments.minutes}
    _check(config)
    return make_folder(arguments.resume), config


def _check(config: dict[str, Any]) -> None:
    choose_environment(config["env"])
    choose("engine", config.get("engine", "sb3"), ENGINES)
    lowest = {
        "steps": 0 if config.get("imitate") else 1,
        "minutes": 0.001,
        "imitate": 0,
        "threads": 1,
        "evaluations": 0,
        "evaluation_episodes": 1,
        "recordings": 0,
        "env_runners": 1,
        "checkpoint_minutes": 0.0,
    }
    check_bounds(config, lowest)
    if config.get("engine") == "rllib" and config["steps"] is None:
        raise BadInputError("--engine rllib needs --steps, and does not support --minutes")
    if config.get("imitate") and config["algo"] != "ppo":
        raise BadInputError(f"imitate must be 0 for {config['algo']}, got {config['imitate']}: only ppo can imitate")
    check_seeds("seed", config["seed"], 1, RUNS)
    check_seeds("evaluation_seed", config["evaluation_seed"], config["evaluation_episodes"], VALIDATION)


def _new_folder(arguments: TrainArguments) -> Path:
    name = f"{arguments.algo}-{arguments.seed}-{time.strftime('%Y%m%d-%H%M%S')}"
    return arguments.out / arguments.env.rpartition("/")[2] / name
