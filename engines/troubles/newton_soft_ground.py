"""A box sinks into the ground, the deeper the heavier it is.

By default a contact has a stiffness of 2500 N/m, whatever its load.

Kind: sinking
"""

import newton

SIDE, G, KE, DT, CORNERS, MASS = 0.5, 9.81, 2500.0, 1e-3, 4, 20.0


def sunk(mass: float) -> float:
    """Return how deep a box is in the ground after two seconds at rest on it [m]."""
    builder = newton.ModelBuilder()
    builder.add_ground_plane()
    box = builder.add_body(xform=(0, 0, SIDE / 2, 0, 0, 0, 1))
    config = newton.ModelBuilder.ShapeConfig(density=mass / SIDE**3)
    builder.add_shape_box(box, hx=SIDE / 2, hy=SIDE / 2, hz=SIDE / 2, cfg=config)
    model = builder.finalize(device="cpu")
    solver, pipeline = newton.solvers.SolverSemiImplicit(model), newton.CollisionPipeline(model)
    now, then, control, contacts = model.state(), model.state(), None, pipeline.contacts()
    for _ in range(2000):
        now.clear_forces()
        pipeline.collide(now, contacts)
        solver.step(now, then, control, contacts, DT)
        now, then = then, now
    return SIDE / 2 - float(now.body_q.numpy()[0, 2])


found, springs = sunk(MASS), MASS * G / (CORNERS * KE)
print(f"newton {newton.__version__}: expected 0 m, as of a box of 1 kg {sunk(1.0):.4f} m")
print(f"found    {found:.4f} m; m g/(4 ke) is {springs:.4f} m")
print(__doc__.splitlines()[2])
raise SystemExit(abs(found - springs) > 0.02 * springs)
