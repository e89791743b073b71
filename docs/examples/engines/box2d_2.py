"""Box2D 2.3, by its Python package. Set up: `pip install Box2D==2.3.10`."""

import Box2D
from Box2D import b2PolygonShape, b2World
from files import local, main


class Engine:
    """A world of Box2D."""

    NAME, VERSION, DIMENSIONS = "Box2D", "2.3 (Box2D 2.3.10)", (2,)
    SETTINGS = {
        "documented": ("8 velocity and 3 position iterations, 1/60 s", {"step": 1 / 60, "sweeps": (8, 3)}),
        "best": ("100 and 20 iterations, 1/480 s", {"step": 1 / 480, "sweeps": (100, 20)}),
    }

    def __init__(self, scene, settings):
        # Bodies that sleep no longer move: what stands would be decided by that.
        self.world = b2World(gravity=tuple(scene["gravity"]), doSleep=False)
        self.settings, self.mu = settings, scene["friction"]

    def add(self, given):
        """Add a body; Box2D takes the root of the product of frictions."""
        make = self.world.CreateStaticBody if given["fixed"] else self.world.CreateDynamicBody
        body = make(position=tuple(given.get("centre", (0, 0))))
        for polygon in given["polygons"]:
            shape = b2PolygonShape(vertices=[tuple(each) for each in local(given, polygon)])
            body.CreateFixture(shape=shape, density=1.0, friction=self.mu, restitution=0.0)
        if not given["fixed"]:
            body.massData = Box2D.b2MassData(mass=given["mass"], center=(0, 0), I=given["inertia"])
            body.linearVelocity = tuple(given["velocity"])
            body.angularVelocity = given["spin"]
        return body

    def push(self, body, force, lever):
        """Push at a point for one step."""
        body.ApplyForce(tuple(force), body.GetWorldPoint(tuple(lever)), True)

    def step(self):
        """Go on by one step."""
        self.world.Step(self.settings["step"], *self.settings["sweeps"])

    def pose(self, body, late):
        """Return x, y and angle."""
        (x, y), (u, v) = body.worldCenter, body.linearVelocity
        return [x + u * late, y + v * late, body.angle + body.angularVelocity * late]


if __name__ == "__main__":
    main(Engine)
