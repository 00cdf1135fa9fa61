"""The specification of a task, written from its declaration."""

import itertools

from .task import Task

READINGS = {
    "position": ("position of {n} nodes from the centre of mass", "body length"),
    "velocity": ("velocity of {n} nodes", "body lengths/s"),
    "curvature": ("curvature about the normal and binormal, and twist, at {n} places", "10/m"),
    "roll": ("up component of normal and binormal at {n} places", "1"),
    "contact": ("force with which the ground carries each of {n} parts", "an equal share of the weight"),
    "touch": ("force with which objects touch each of {n} parts", "an equal share of the weight"),
    "object/position": ("position of an object's centre from the head", "body length"),
    "object/axis": ("unit vector along its axis", "1"),
    "object/velocity": ("its velocity", "body lengths/s"),
    "object/spin": ("its angular velocity", "rad/s"),
    "object/gap": ("its gap to the body's surface, negative where they overlap", "body length"),
    "activation": ("activation that each muscle has reached", "1"),
    "clock": ("sine and cosine of a clock with a period of 1 s", "1"),
    "time_left": ("part of the episode that is left", "1"),
}
"""By kind, what observations of every task mean, and their unit"""


def document(task: Task) -> str:
    """Return what a task observes, is rewarded for, and ends with, as tables in Markdown."""
    body = task.make_body()
    weights = [f"| {name} | {weight:g} |" for name, weight in task.reward_weights.items()]
    reasons = [
        f"{number} {name}"
        for number, name in enumerate(task.termination_reasons)
        if name != "success" or task.ends_on_success
    ]
    return "\n".join(
        [
            *_section("Action"),
            f"``Box(-1, 1, ({body.n_activations},), float32)``: the activations that the muscles are "
            "commanded to; see `elastica_gym.bodies.muscles`.",
            "",
            *_section("Observation"),
            "``Box(float32)``, clipped to its range.",
            "",
            "| index | meaning | unit | range |",
            "|---|---|---|---|",
            *_rows(task.observations(body)),
            "",
            *_section("Rewards"),
            "The sum of these terms, each of which is in the info as ``reward_<term>`` with its weight:",
            "",
            "| term | weight |",
            "|---|---|",
            *weights,
            "",
            "The info also has ``distance`` [m]; ``is_success``; and",
            f"``termination_reason``, a number: {', '.join(reasons[:-1])} or {reasons[-1]}.",
            "",
            *_section("Starting state"),
            f"``spread`` is one of {', '.join(task.starts)}.",
            "",
            *_section("Episode end"),
            f"Truncated after {task.duration:g} s.",
            "",
        ]
    )


def _section(title: str) -> list[str]:
    return [title, "-" * len(title)]


def _rows(observations: list[tuple[str, float, float]]) -> list[str]:
    """Return a row for each run of observations of one kind and range."""
    rows, first = [], 0
    for (kind, low, high), group in itertools.groupby(observations, lambda each: (_kind(each[0]), *each[1:])):
        names = [name for name, *_ in group]
        last = first + len(names) - 1
        index = f"{first}" if last == first else f"{first}-{last}"
        meaning, unit = READINGS.get(kind, (", ".join(names), ""))
        count = len({name.split("/")[1] for name in names}) if "{n}" in meaning else 0
        rows.append(f"| {index} | {meaning.format(n=count)} | {unit} | {low:g} to {high:g} |")
        first = last + 1
    return rows


def _kind(name: str) -> str:
    """Return the kind of a reading; the names of goals stay whole, for each is its own."""
    first, *rest = name.split("/")
    kind = f"object/{rest[1]}" if first == "object" else first
    return kind if kind in READINGS else name
