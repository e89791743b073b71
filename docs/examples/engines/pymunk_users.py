"""pymunk, as its users run it. Set up: `pip install pymunk==7.3.1`."""

import math

import pymunk
from files import local, main


class Engine:
    """A space of pymunk."""

    NAME, VERSION, DIMENSIONS = "pymunk", pymunk.version, (2,)
    SETTINGS = {
        "documented": ("10 iterations, 1/60 s, collision_slop 0.1", {"step": 1 / 60, "sweeps": 10, "slop": 0.1}),
        "best": ("100 iterations, 1/960 s, collision_slop 1e-4", {"step": 1 / 960, "sweeps": 100, "slop": 1e-4}),
    }

    def __init__(self, scene, settings):
        self.space, self.settings, self.mu = pymunk.Space(), settings, scene["friction"]
        self.space.gravity, self.space.iterations = tuple(scene["gravity"]), settings["sweeps"]
        self.space.collision_slop = settings["slop"]
        self.pushes = []

    def add(self, given):
        """Add a body; pymunk multiplies frictions."""
        body = self.space.static_body
        if not given["fixed"]:
            body = pymunk.Body(given["mass"], given["inertia"])
            body.position, body.velocity = tuple(given["centre"]), tuple(given["velocity"])
            body.angular_velocity = given["spin"]
            self.space.add(body)
        for polygon in given["polygons"]:
            shape = pymunk.Poly(body, [tuple(corner) for corner in local(given, polygon)])
            shape.friction = math.sqrt(self.mu)
            self.space.add(shape)
        return body

    def push(self, body, force, lever):
        """Push at a point for one step."""
        body.apply_force_at_world_point(tuple(force), body.local_to_world(tuple(lever)))

    def step(self):
        """Go on by one step."""
        self.space.step(self.settings["step"])

    def pose(self, body, late):
        """Return x, y and angle."""
        (x, y), (u, v) = body.position, body.velocity
        return [x + u * late, y + v * late, body.angle + body.angular_velocity * late]


if __name__ == "__main__":
    main(Engine)
