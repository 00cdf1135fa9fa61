"""The page of an environment, in Markdown, generated from its task and its body."""

import functools
import inspect
from collections.abc import Callable, Iterator
from typing import Any

from ..bodies.body import Body
from ..bodies.muscles import DIRECTIONS, N_FUNCTIONS
from .batch import CONTROL_DT
from .initial_states import bent, with_object_held
from .task import Task, TerminationReason

EFFECTS = {"normal": "bends sideways", "binormal": "lifts", "tangent": "twists"}
"""Effect of the muscles in each direction"""


def document(task: Task) -> str:
    """Return the specification of a task as Markdown: action, observation, rewards, start and end."""
    body = task.make_body()
    about, _, history = task.description.partition("Version history\n---------------\n")
    title, _, text = about.strip().partition("\n")
    parts = [
        f"# {task.name}",
        _sentence(title.partition(": ")[2] or title),
        text.strip(),
        *_action(body),
        *_observation(task, body),
        *_rewards(task),
        *_start(task),
        *_end(task, body),
        "## Arguments",
        "Those of `elastica_gym.envs.BatchEnv`: ``control_dt``, ``sim_dt`` "
        f"({body.sim_dt:g} s), ``duration``, ``max_episode_steps``, ``n_threads``, ``weights``, ``spread``, "
        "``body_kwargs``, ``render_mode``, ``render_size``; with `make_vec`, also ``autoreset_mode``.",
    ]
    if history:
        parts += ["## Version history", "\n".join(f"- {line}" for line in history.strip().split("\n"))]
    return "\n\n".join(part for part in parts if part) + "\n"


def _action(body: Body) -> Iterator[str]:
    yield "## Action"
    yield (
        f"``Box(-1, 1, ({body.n_activations},), float32)``: the commanded muscle activations, held for a control step "
        "and clipped to the range. Muscles follow with a time constant of "
        f"{body.muscles.activation_time:g} s. An action of the wrong shape or with NaN raises ValueError."
    )
    rows = []
    for direction in DIRECTIONS:
        for arm in body.muscles.arms:
            first, *_, last = body.muscles.columns(direction, arm)
            rows.append(f"| {first}-{last} | about the {direction}: {EFFECTS[direction]} | {arm} |")
    yield "\n".join(["| index | direction | arm |", "|---|---|---|", *rows])
    yield (
        f"Each row has the {N_FUNCTIONS} basis functions of `elastica_gym.bodies.muscles`: level 0, then 2 of level 1, "
        "then 4 of level 2, each in order from the arm's beginning to its end."
    )


def _observation(task: Task, body: Body) -> Iterator[str]:
    yield "## Observation"
    yield (
        f"``Box(float32)``, clipped to its range. Directions are in the frame of the heading: {body.frame}; right is "
        "to the right of forward, seen from above; up is y."
    )
    layout, rows = task.layout(body), []
    for block in layout.blocks:
        columns = layout[block.name]
        index = f"{columns.start}-{columns.stop - 1}" if len(block.parts) > 1 else f"{columns.start}"
        bounds = f"{block.low:g} to {block.high:g}"
        rows.append(f"| {index} | `{block.name}` | {block.meaning} | {block.unit} | {bounds} |")
    yield "\n".join(["| index | block | meaning | unit | range |", "|---|---|---|---|---|", *rows])


def _rewards(task: Task) -> Iterator[str]:
    yield "## Rewards"
    yield "The sum of these terms, each of which is in the info, weighted, as ``reward_<term>``:"
    rows = [
        f"| {name} | {task.reward_weights[name]:g} | {_returned(term)} |" for name, term in task.reward_terms.items()
    ]
    rows.append(f"| diverged | {task.reward_weights['diverged']:g} | 1 if the simulation has diverged; all other "
                "terms are then 0 |")  # fmt: skip
    yield "\n".join(["| term | weight | formula, per control step |", "|---|---|---|", *rows])
    reasons = [
        f"{number} {name}"
        for number, name in enumerate(task.termination_reasons)
        if name != TerminationReason.SUCCESS.name.lower() or task.ends_on_success
    ]
    yield (
        f"The info also has ``distance``: {_returned(task.distance)}; ``is_success``: {_returned(task.succeeds)}; and "
        f"``termination_reason``, a number: {', '.join(reasons[:-1])} or {reasons[-1]}."
    )


def _start(task: Task) -> Iterator[str]:
    yield "## Starting state"
    yield "Drawn from the environment's own generator. ``spread`` is one of these, by default the first:"
    yield "\n".join(f"- ``{name}``: {_described(start)}" for name, start in task.initial_states.items())
    if any(start is not bent and start is not with_object_held for start in task.initial_states.values()):
        yield f"The animal, unless its arm holds the object: {_described(bent)}"
    yield f"The goal: {_described(task.sample_goal)}"


def _end(task: Task, body: Body) -> Iterator[str]:
    yield "## Episode end"
    ends = ["at success"] if task.ends_on_success else []
    ends += [f"as {name} if {_returned(failed).removeprefix('whether ')}" for name, failed in task.failures.items()]
    ends.append(
        f"as diverged if a number is not finite or a speed exceeds {body.sensors.fastest:g} m/s: the last valid "
        "observation is then returned"
    )
    yield (
        f"Truncated after {task.duration:g} s ({round(task.duration / CONTROL_DT)} control steps). "
        f"Terminated {'; '.join(ends)}."
    )


def _returned(function: Callable[..., Any]) -> str:
    """Return the first line of a function's docstring, without ``Return`` and the shape."""
    first = _doc(function).split("\n")[0].removeprefix("Return ").removesuffix(".")
    for shape in (", (B,) bool", ", (B,)"):
        first = first.removesuffix(shape)
    return first


def _described(function: Callable[..., Any]) -> str:
    """Return the docstring of a function on one line."""
    return _sentence(" ".join(_doc(function).removeprefix("Return ").removeprefix("Write ").split()))


def _sentence(text: str) -> str:
    """Return a text with its first letter capitalised."""
    return text[:1].upper() + text[1:]


def _doc(function: Callable[..., Any]) -> str:
    while isinstance(function, functools.partial):
        function = function.func
    return inspect.getdoc(function) or ""
