"""Learning curves as a recording for rerun."""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..engine.model import Array
from .recording import import_rerun, write_stream

if TYPE_CHECKING:
    import rerun


def write_curves(lines: Mapping[tuple[str, str], tuple[Array, Array]], path: Path) -> Path:
    """Write curves to a recording: a plot a quantity, a line a setting.

    Parameters
    ----------
    lines : mapping
        By quantity and setting, the environment steps, (P,), and the values, (P,).
    path : Path
        The file, which ends in .rrd.
    """
    rr = import_rerun()
    import rerun.blueprint as rrb

    quantities = list(dict.fromkeys(quantity for quantity, _ in lines))
    views = [rrb.TimeSeriesView(origin=f"/{quantity}", name=quantity) for quantity in quantities]

    def log(stream: "rerun.RecordingStream") -> None:
        stream.send_blueprint(rrb.Blueprint(rrb.Grid(*views), collapse_panels=True))
        for (quantity, setting), (steps, values) in lines.items():
            entity = rr.new_entity_path([quantity, setting])
            stream.log(entity, rr.SeriesLines(names=[setting]), static=True)
            index = rr.TimeColumn("steps", sequence=np.round(steps).astype(np.int64))
            stream.send_columns(entity, [index], rr.Scalars.columns(scalars=values))

    return write_stream(log, path)
