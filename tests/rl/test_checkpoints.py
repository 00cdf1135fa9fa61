import os
from pathlib import Path

import pytest

from elastica_gym import files
from elastica_gym.rl import checkpoints


def write(folder: Path, steps: int, text: str = "weights") -> Path:
    return checkpoints.write_checkpoint(folder, steps, lambda place: (place / "model.zip").write_text(text))


def test_the_last_checkpoints_are_kept(tmp_path):
    written = [write(tmp_path, steps) for steps in (100, 200, 1000)]
    assert checkpoints.checkpoint_folders(tmp_path) == written[1:]
    assert checkpoints.last_whole_checkpoint(tmp_path) == written[-1]


@pytest.mark.parametrize(
    "damage",
    [
        lambda folder: (folder / "model.zip").write_text("weighty"),
        lambda folder: (folder / "model.zip").write_text(""),
        lambda folder: (folder / "model.zip").unlink(),
        lambda folder: (folder / checkpoints.CHECKSUMS).unlink(),
        lambda folder: (folder / checkpoints.CHECKSUMS).write_text("[1"),
        lambda folder: (folder / checkpoints.CHECKSUMS).write_text("[1]"),
    ],
)
def test_a_damaged_checkpoint_is_reported_and_skipped(tmp_path, damage):
    whole, broken = write(tmp_path, 1), write(tmp_path, 2)
    damage(broken)
    told = []
    assert checkpoints.last_whole_checkpoint(tmp_path, tell=told.append) == whole
    assert len(told) == 1 and str(broken) in told[0]


def test_a_failing_write_leaves_the_previous_one(tmp_path):
    whole = write(tmp_path, 1)

    def fail(place: Path) -> None:
        (place / "model.zip").write_text("half")
        raise OSError(28, "No space left on device")

    with pytest.raises(OSError, match="No space"):
        checkpoints.write_checkpoint(tmp_path, 2, fail)
    assert os.listdir(tmp_path) == [whole.name]
    assert checkpoints.find_damage(whole) is None


def test_leftovers_of_a_killed_process_are_removed(tmp_path):
    (tmp_path / ".writing-123").mkdir(parents=True)
    whole = write(tmp_path, 1)
    assert os.listdir(tmp_path) == [whole.name]


def test_a_file_is_replaced_atomically(tmp_path):
    path = tmp_path / "model.zip"
    files.write_atomically(path, lambda place: place.write_text("old"))
    with pytest.raises(OSError):
        files.write_atomically(path, lambda place: place.joinpath("no").write_text("new"))
    assert path.read_text() == "old"
    assert os.listdir(tmp_path) == ["model.zip"]
