"""Contact by pair: rods with rigid bodies, and rods with rods."""

from ...jit.compiler import inline
from ..contact.pairs import contact_of_rods, contact_with_bodies
from ..layout import end_of, rows


@inline
def apply(model, scene, state, control):
    """Add its loads to the external loads."""
    s, force, torque = state, control.force[0], control.torque[0]
    if scene.body_contacts.body.size > 0:
        bodies = s.body_x[0], s.body_v[0], s.body_Q[0], s.body_w[0], s.body_force[0], s.body_torque[0]
        contact_with_bodies(
            scene.body_contacts, model.cylinders, s.scratch[0], s.x[0], s.v[0], s.Q[0], s.w[0], s.length[0],
            model.contact_radius, bodies, force, torque,
        )  # fmt: skip
    if scene.rod_contacts.stiffness.size > 0:
        s.n_neighbours[0] = contact_of_rods(
            end_of(model), scene.rod_contacts, s.n_neighbours[0], rows(s.neighbour_x[0]), s.neighbour_reach[0],
            s.scratch[0], s.x[0], s.v[0], s.Q[0], s.w[0], s.length[0], model.contact_radius, force, torque,
        )  # fmt: skip
