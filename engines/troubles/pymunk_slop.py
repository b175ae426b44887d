"""A fallen block stays sunk in the floor.

No depth below collision_slop is corrected; the slop is 0.1 in whatever unit of length is used.

Kind: sinking
"""

import pymunk

DT, G, HEIGHT = 0.02, 9.81, 1.0
print("pymunk", pymunk.version)
space = pymunk.Space()
space.gravity = 0, -G
block = pymunk.Body(1, 1 / 6)
block.position = 0, 0.5 + HEIGHT
floor = pymunk.Segment(space.static_body, (-9, 0), (9, 0), 0)
space.add(floor, block, pymunk.Poly.create_box(block, (1, 1)))
for _ in range(1000):
    space.step(DT)
found = 0.5 - block.position.y
depths = (0.5 * G * DT**2 * n * (n - 1) - HEIGHT for n in range(1, 1000))
first = next(depth for depth in depths if depth > 0)
print("expected 0.0000 m deep, 20 s after it fell by 1 m")
print(f"found    {found:.4f} m; its first step within, g dt^2 n (n - 1)/2 - h, gives {first:.4f}")
print(__doc__.splitlines()[2])
raise SystemExit(not (abs(found - first) < 1e-3 and first < space.collision_slop))
