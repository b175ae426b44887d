"""A floor that is put from place to place carries nothing.

Friction acts by the floor's velocity, and a position that is set leaves that at zero.

Kind: teleport
"""

import pymunk

V, T, DT, MU, G = 0.5, 1.0, 1e-3, 0.5, 9.81
print("pymunk", pymunk.version)


def carried(*, by_velocity):
    """Return how far [m] a floor that moves V T carries a block."""
    space = pymunk.Space()
    space.gravity = 0, -G
    floor, block = pymunk.Body(body_type=pymunk.Body.KINEMATIC), pymunk.Body(1, 1 / 6)
    block.position = 0, 0.5
    top, box = pymunk.Segment(floor, (-9, 0), (9, 0), 0), pymunk.Poly.create_box(block, (1, 1))
    top.friction, box.friction = 1, MU  # of a pair the product counts
    space.add(floor, top, block, box)
    for step in range(round(T / DT)):
        if by_velocity:
            floor.velocity = V, 0
        else:
            floor.position = V * (step + 1) * DT, 0
        space.step(DT)
    return block.position.x


expected, found = V * T - V**2 / (2 * MU * G), carried(by_velocity=False)
print(
    f"expected {expected:.4f} m = v t - v^2/(2 mu g); by velocity: {carried(by_velocity=True):.4f}"
)
print(f"found    {found:.4f} m by positions")
print(__doc__.splitlines()[2])
raise SystemExit(abs(found) > 1e-3)
