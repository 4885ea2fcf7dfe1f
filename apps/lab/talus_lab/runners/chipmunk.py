"""Scenes with Chipmunk, through pymunk. Settings: `rate` (steps per s), `iterations` of the solver, `slop` (m: overlap that the library
leaves alone; the world is scaled so that its own, 0.1, becomes this), `radius` (of rounding, in slops), `bias` (share of an overlap left
after a step), `restitution`. With half a slop of rounding, blocks that touch overlap by a slop and are at rest where they are.

Every bonded face becomes two pivots, one at each of its ends, and no contact.
"""

from __future__ import annotations

import pymunk
from pymunk._chipmunk_cffi import lib

from talus_lab.runners.scene import common_friction, drive, main, welds

SLOP = 0.1  # of the library, in its units of length
BIAS = 0.9**60  # share of an overlap that is left after 1 s, of the library


def compute(scene: dict) -> dict:
    given = scene["settings"]
    scale, rate = SLOP / given.get("slop", 0.5e-3), given.get("rate", 240)
    space = pymunk.Space()
    space.iterations = int(given.get("iterations", 10))
    space.collision_slop = SLOP
    space.collision_bias = given["bias"] ** rate if "bias" in given else BIAS
    friction = common_friction(scene) ** 0.5  # shapes multiply theirs
    bodies = [add_block(space, block, scale, friction, given) for block in scene["blocks"]]
    for weld in welds(scene):
        for end in ("from", "to"):
            joint = pymunk.PivotJoint(bodies[weld["a"]], bodies[weld["b"]], tuple(scale * x for x in weld[end]))
            joint.collide_bodies = False
            joint.error_bias = space.collision_bias
            space.add(joint)

    def look() -> tuple[list, list]:
        return [[x / scale for x in body.position] for body in bodies], [body.angle for body in bodies]

    def pull(x: float, y: float) -> None:
        space.gravity = scale * x, scale * y

    inner = space._space

    def step(dt: float) -> None:
        lib.cpSpaceStep(inner, dt)  # space.step takes three times as long where there is little to do, all of it in Python

    return drive(scene, rate, step, look, pull)


def add_block(space: pymunk.Space, block: dict, scale: float, friction: float, given: dict) -> pymunk.Body:
    kind = pymunk.Body.STATIC if block["held"] else pymunk.Body.DYNAMIC
    body = pymunk.Body(block["mass"], block["inertia"] * scale**2, body_type=kind)
    body.position = tuple(scale * x for x in block["position"])
    body.velocity = tuple(scale * v for v in block["velocity"])
    space.add(body)
    for part in block["parts"]:
        shape = pymunk.Poly(body, [(scale * x, scale * y) for x, y in part], radius=SLOP * given.get("radius", 0.5))
        shape.friction, shape.elasticity = friction, given.get("restitution", 0.0)
        space.add(shape)
    return body


if __name__ == "__main__":
    main(compute)
