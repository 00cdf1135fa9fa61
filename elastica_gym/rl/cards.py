"""Pretrained policies: each is a model, its observation statistics, and a card with its provenance.

A policy NAME consists of NAME.zip, a Stable-Baselines3 model without its training state; NAME.npz, its observation
normalisation, if any; and NAME.yml, its card. All are in ``agents/pretrained``.
"""

import shlex
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from ..console.bad_input import BadInputError, choose
from ..files import shipped, write_atomically
from .hyperparameters import load
from .policies import Statistics, TrainedPolicy, load_model

PRETRAINED = shipped("pretrained")
LARGEST = 5_000_000
"""Maximum size of all pretrained policies together [bytes]"""
ONLY_FOR_TRAINING = ("_last_obs", "_last_original_obs", "_last_episode_starts", "ep_info_buffer", "ep_success_buffer")
"""Attributes of a model that are only needed to continue training"""


def names(folder: Path = PRETRAINED) -> list[str]:
    """Return the names of the pretrained policies."""
    return sorted(path.stem for path in folder.glob("*.yml"))


def load_pretrained(name: str, folder: Path = PRETRAINED) -> tuple[TrainedPolicy, dict[str, Any]]:
    """Load a pretrained policy.

    Returns
    -------
    policy
        The model with its normalisation.
    card
        ``environment``, ``algorithm``, ``seed``, ``command``, ``hyperparameters``, ``score``, the meaning of its
        ``intervals``, the machines it was ``scored_on`` and ``trained_on``, and more.
    """
    card = read_card(name, folder)
    model = load_model(folder / f"{name}.zip", card["algorithm"])
    return TrainedPolicy(model, read_statistics(folder / f"{name}.npz")), card


def read_card(name: str, folder: Path = PRETRAINED) -> dict[str, Any]:
    """Return the card of a pretrained policy."""
    return yaml.safe_load((folder / f"{choose('pretrained policy', name, names(folder))}.yml").read_text())


def cards_of(env_id: str) -> list[dict[str, Any]]:
    """Return the cards of the policies that ship for an environment."""
    return [card for card in map(read_card, names()) if card["environment"] == env_id]


def read_statistics(path: Path) -> Statistics | None:
    """Read the normalisation of observations, or return None if there is none."""
    if not path.exists():
        return None
    try:
        with np.load(path, allow_pickle=False) as saved:
            return Statistics(saved["mean"], saved["variance"], float(saved["epsilon"]), float(saved["clip"]))
    except Exception as error:  # a damaged archive can raise almost anything
        raise BadInputError(f"The statistics {path} are damaged: {type(error).__name__}: {error}") from error


def write_pretrained(folder: Path, name: str, policy: TrainedPolicy, card: dict[str, Any]) -> list[Path]:
    """Write a policy and then its card, and return the files.

    Raises
    ------
    BadInputError
        If the folder would become larger than `LARGEST`; it is then left unchanged.
    """
    model, paths = policy.model, [folder / f"{name}{suffix}" for suffix in (".zip", ".npz", ".yml")]
    for optimizer in _optimizers(model):
        optimizer.state.clear()
    temporary = folder / f".writing-{name}"
    with temporary.open("wb") as file:
        model.save(file, exclude=ONLY_FOR_TRAINING)
    others = sum(path.stat().st_size for path in folder.iterdir() if path not in (temporary, *paths))
    size = others + temporary.stat().st_size
    if size > LARGEST:
        temporary.unlink()
        raise BadInputError(f"{folder} would take {size / 1e6:.1f} MB; at most {LARGEST / 1e6:g} MB are allowed.")
    temporary.replace(paths[0])
    paths[1].unlink(missing_ok=True)
    if policy.normalization is not None:
        _write_statistics(paths[1], policy.normalization)
    write_card(folder, name, card)
    return [path for path in paths if path.exists()]


def write_card(folder: Path, name: str, card: dict[str, Any]) -> Path:
    """Write the card of a policy and return its path."""
    text, path = yaml.safe_dump(card, sort_keys=False, width=120), folder / f"{name}.yml"
    write_atomically(path, lambda path: path.write_text(text))
    return path


def _optimizers(model: Any) -> list[Any]:
    names, _ = model._get_torch_save_params()
    found = []
    for name in names:
        owner = model
        for part in name.split("."):
            owner = getattr(owner, part)
        if name.endswith("optimizer"):
            found.append(owner)
    return found


def _write_statistics(path: Path, normalization: Any) -> None:
    with path.open("wb") as file:
        np.savez(
            file,
            mean=normalization.obs_rms.mean,
            variance=normalization.obs_rms.var,
            epsilon=normalization.epsilon,
            clip=normalization.clip_obs,
        )


def command_of(config: dict[str, Any]) -> str:
    """Return the command that reproduces a run with this ``config.yml``."""
    values = config["hyperparameters"]
    file = config.get("config")
    shipped = load(config["algo"], config["env"], config=file and Path(file))
    words = ["python", "-m", "agents.train", "--env", config["env"], "--algo", config["algo"]]
    words += ["--seed", str(config["seed"])]
    if config.get("steps") not in (None, shipped["n_timesteps"]):
        words += ["--steps", str(config["steps"])]
    if config.get("minutes") is not None:
        words += ["--minutes", f"{config['minutes']:g}"]
    if file is not None:
        words += ["--config", file]
    if config.get("start_from") is not None:
        start = config["start_from"]
        # keep only the id and the name of the run: its folder differs between machines
        words += ["--start-from", start if start in names() else str(Path("runs", *Path(start).parts[-2:]))]
    if config.get("imitate"):
        words += ["--imitate", str(config["imitate"])]
    changed = {key: value for key, value in values.items() if shipped.get(key) != value}
    if changed:
        flow = (yaml.safe_dump(value, default_flow_style=True, width=1000) for value in changed.values())
        texts = (text.removesuffix("...\n").strip() for text in flow)
        words += ["--set", *(f"{key}={text}" for key, text in zip(changed, texts, strict=True))]
    return shlex.join(words)
