"""Progress in logs, which stay short, and on terminals, with a fake clock."""

import io

import pytest

from elastica_gym import progress
from elastica_gym.progress import Bar, LogLines, track


@pytest.fixture
def clock(monkeypatch):
    """Fake time of the progress display [s]."""
    now = [1000.0]
    monkeypatch.setattr(progress.time, "monotonic", lambda: now[0])
    return now


class Terminal(io.StringIO):
    def isatty(self):
        return True


def test_a_log_has_a_line_for_every_tenth(clock):
    log = io.StringIO()
    with Bar("running", file=log) as bar:
        for step in range(1, 10_001):
            clock[0] += 0.01
            bar.show(step / 10_000)
    lines = log.getvalue().splitlines()
    assert lines[0] == "running ..." and lines[-1] == "running: 100%"
    assert len(lines) == 11 and "\r" not in log.getvalue()


def test_a_quick_task_leaves_one_line_in_a_log(clock):
    log = io.StringIO()
    with Bar("running", file=log) as bar:
        for step in range(1, 101):
            clock[0] += 0.01
            bar.show(step / 100)
    assert log.getvalue() == "running ...\n"


def test_a_log_is_not_silent_for_longer_than_five_minutes(clock):
    lines = LogLines()
    due = []
    for _ in range(3600):
        clock[0] += 1.0
        due.append(lines.is_due(0.01))
    assert 11 <= sum(due) <= 13


def test_numbers_are_in_the_line(clock):
    log = io.StringIO()
    with Bar("searching", file=log) as bar:
        clock[0] += 60.0
        bar.show(0.25, {"home": 0.5, "unknown": float("nan"), "steps": 12345.0})
    assert log.getvalue().splitlines()[1] == "searching: 25%  home 0.5  steps 12,345"


def test_a_terminal_has_a_bar_that_disappears():
    terminal = Terminal()
    with Bar("running", file=terminal) as bar:
        assert "running:   0%" in terminal.getvalue()  # shown before the first update
        bar.show(0.5)
        bar.show(1.0)
    assert "\n" not in terminal.getvalue() and terminal.getvalue().endswith("\r")


def test_track_yields_all(capsys):
    assert list(track(range(5), "counting")) == [0, 1, 2, 3, 4]
    assert capsys.readouterr().err == "counting ...\n"


def test_a_line_is_printed_above_the_bar():
    terminal = Terminal()
    with Bar("running", file=terminal) as bar:
        bar.show(0.5)
        bar.say("a checkpoint")
    assert "a checkpoint\n" in terminal.getvalue()
