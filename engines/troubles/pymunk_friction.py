"""A block slides off the least slope.

A shape's friction is 0 unless it is set, and of a pair the product counts.

Kind: friction model
"""

import math

import pymunk

DT, G, SLOPE, T = 0.02, 9.81, 0.01, 1.0
print("pymunk", pymunk.version)
space = pymunk.Space()
space.gravity = G * math.sin(SLOPE), -G * math.cos(SLOPE)
block = pymunk.Body(1, 1 / 6)
block.position = 0, 0.5
floor = pymunk.Segment(space.static_body, (-9, 0), (9, 0), 0)
space.add(floor, block, pymunk.Poly.create_box(block, (1, 1)))
for _ in range(round(T / DT)):
    space.step(DT)
found, slides = block.position.x, 0.5 * G * math.sin(SLOPE) * T * (T - DT)
print(f"expected 0.0000 m for any friction above tan(slope) = {math.tan(SLOPE):.4f}")
print(f"found    {found:.4f} m; without friction g sin(slope) t (t - dt)/2 gives {slides:.4f}")
print(__doc__.splitlines()[2])
raise SystemExit(abs(found - slides) > 1e-4)
