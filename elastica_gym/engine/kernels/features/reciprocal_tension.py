"""The tension that makes the documented internal loads derive from a potential, on the rods that enable it."""

from ...jit.compiler import inline
from ..layout import matrix, rows, span_of
from ..rod.tension import bend_energy_rates, reciprocate


@inline
def apply(model, scene, state, control):
    """Add it to the external loads."""
    for j in range(scene.tensions.is_closed.size):
        first, last = span_of(scene.tensions.span[j])
        bend_energy_rates(
            first, last, state.length[0], rows(state.kappa[0]), rows(control.rest_kappa[0]), model.rest_voronoi_length,
            rows(model.bend), rows(model.inv_bend), model.is_muscular, rows(state.couple[0]), state.scratch[0, 0],
        )  # fmt: skip
        reciprocate(
            first, last, scene.tensions.is_closed[j], rows(state.x[0]), matrix(state.Q[0]), rows(state.w[0]),
            state.length[0], model.rest_length, model.inv_rest_length, rows(control.rest_sigma[0]), rows(model.shear),
            rows(model.inertia), state.scratch[0, 0], control.force[0],
        )  # fmt: skip
