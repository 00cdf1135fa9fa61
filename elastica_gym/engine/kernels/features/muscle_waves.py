"""Travelling waves of muscle couple."""

from ...jit.compiler import inline
from ..layout import matrix, rows, span_of
from ..rod.loads import wave


@inline
def apply(model, scene, state, control):
    """Add them to the external loads."""
    waves, time = scene.waves, state.time[0]
    for j in range(waves.ramp_time.size):
        first, n = span_of(scene.wave_span[j])
        strength = time / waves.ramp_time[j] if time < waves.ramp_time[j] else 1.0
        wave(first, n, strength, waves.angular_frequency[j] * time, waves.axis[j], waves.sine[j], waves.cosine[j],
             matrix(state.Q[0]), rows(control.torque[0]))  # fmt: skip
