"""The page of an environment, in Markdown, written from the declaration of its task and its body."""

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
"""What muscles of each direction do"""


def document(task: Task) -> str:
    """Return the specification of a task: action, observation, rewards, start and end, as tables in Markdown."""
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
        "``body_kwargs``, ``render_mode``, ``render_size``; and of `make_vec` ``autoreset_mode``.",
    ]
    if history:
        parts += ["## Version history", "\n".join(f"- {line}" for line in history.strip().split("\n"))]
    return "\n\n".join(part for part in parts if part) + "\n"


def _action(body: Body) -> Iterator[str]:
    yield "## Action"
    yield (
        f"``Box(-1, 1, ({body.n_activations},), float32)``: the activations that the muscles are commanded to, held "
        "for a control step and clipped to the range. Muscles follow with a time constant of "
        f"{body.muscles.activation_time:g} s. An action of another shape, or one that holds NaN, raises ValueError."
    )
    rows = []
    for direction in DIRECTIONS:
        for arm in body.muscles.arms:
            first, *_, last = body.muscles.columns(direction, arm)
            rows.append(f"| {first}-{last} | about the {direction}: {EFFECTS[direction]} | {arm} |")
    yield "\n".join(["| index | direction | arm |", "|---|---|---|", *rows])
    yield (
        f"Each row has the {N_FUNCTIONS} basis functions of `elastica_gym.bodies.muscles`: level 0, then 2 of level 1, "
        "then 4 of level 2, each from the arm's beginning to its end."
    )


def _observation(task: Task, body: Body) -> Iterator[str]:
    yield "## Observation"
    yield (
        f"``Box(float32)``, clipped to its range. Directions are in the frame of the heading: {body.frame}; right is "
        "to its right seen from above, with y up."
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
    yield "The sum of these terms, each of which is in the info as ``reward_<term>`` with its weight:"
    rows = [
        f"| {name} | {task.reward_weights[name]:g} | {_returned(term)} |" for name, term in task.reward_terms.items()
    ]
    rows.append(f"| diverged | {task.reward_weights['diverged']:g} | 1 where the simulation has diverged, and then all "
                "other terms are 0 |")  # fmt: skip
    yield "\n".join(["| term | weight | formula, a control step |", "|---|---|---|", *rows])
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
    yield "All is drawn from the environment's own generator. ``spread`` is one of these, by default the first:"
    yield "\n".join(f"- ``{name}``: {_described(start)}" for name, start in task.initial_states.items())
    if any(start is not bent and start is not with_object_held for start in task.initial_states.values()):
        yield f"The animal itself, unless its arm holds the object: {_described(bent)}"
    yield f"The goal: {_described(task.sample_goal)}"


def _end(task: Task, body: Body) -> Iterator[str]:
    yield "## Episode end"
    ends = ["at success"] if task.ends_on_success else []
    ends += [f"as {name} if {_returned(failed).removeprefix('whether ')}" for name, failed in task.failures.items()]
    ends.append(
        f"as diverged if numbers stop being finite or something is faster than {body.sensors.fastest:g} m/s: then the "
        "last sound observation is returned"
    )
    yield (
        f"Truncated after {task.duration:g} s, which are {round(task.duration / CONTROL_DT)} control steps. "
        f"Terminated {'; '.join(ends)}."
    )


def _returned(function: Callable[..., Any]) -> str:
    """Return what a function says that it returns, without its shape."""
    first = _doc(function).split("\n")[0].removeprefix("Return ").removesuffix(".")
    for shape in (", (B,) bool", ", (B,)"):
        first = first.removesuffix(shape)
    return first


def _described(function: Callable[..., Any]) -> str:
    """Return the docstring of a function on one line."""
    return _sentence(" ".join(_doc(function).removeprefix("Return ").removeprefix("Write ").split()))


def _sentence(text: str) -> str:
    """Return a text that begins with a capital letter."""
    return text[:1].upper() + text[1:]


def _doc(function: Callable[..., Any]) -> str:
    while isinstance(function, functools.partial):
        function = function.func
    return inspect.getdoc(function) or ""
