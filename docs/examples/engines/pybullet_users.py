"""pybullet, as its users run it. Set up: `pip install pybullet==3.2.7`."""

import math

import pybullet as bullet
from files import angle, main, prism


class Engine:
    """A world of pybullet; planar scenes as prisms."""

    NAME, VERSION, DIMENSIONS = "pybullet", "3.2.7", (2, 3)
    SETTINGS = {
        "documented": ("its defaults: 1/240 s, 50 iterations, hulls", {"step": 1 / 240}),
        "best": (
            "1/240 s, 200 iterations, residual 0, contactSlop and collisionMargin 1e-5, "
            "maximal coordinates, no damping",
            {"step": 1 / 240, "sweeps": 200},
        ),
    }

    def __init__(self, scene, settings):
        bullet.isConnected() or bullet.connect(bullet.DIRECT)
        bullet.resetSimulation()
        self.scene, self.best = scene, "sweeps" in settings
        bullet.setGravity(*[*scene["gravity"], 0.0][:3])
        bullet.setPhysicsEngineParameter(fixedTimeStep=settings["step"])
        if self.best:
            bullet.setPhysicsEngineParameter(
                numSolverIterations=settings["sweeps"],
                solverResidualThreshold=0,
                contactSlop=1e-5,
            )

    def add(self, given):
        """Add a body; pybullet multiplies frictions."""
        parts = [prism(given, shape) for shape in given.get("polygons") or given["polyhedra"]]
        shapes = [
            bullet.createCollisionShape(bullet.GEOM_MESH, vertices=part) for part in parts
        ]
        place = [*given.get("centre", [0.0, 0.0]), 0.0][:3]
        made = [
            bullet.createMultiBody(
                0.0 if given["fixed"] else given["mass"],
                shape,
                basePosition=place,
                useMaximalCoordinates=self.best,
            )
            for shape in shapes
        ]
        for body in made:
            bullet.changeDynamics(
                body, -1, lateralFriction=math.sqrt(self.scene["friction"]), restitution=0
            )
            if self.best:
                bullet.changeDynamics(
                    body, -1, linearDamping=0, angularDamping=0, collisionMargin=1e-5
                )
        if not given["fixed"]:
            about = given["inertia"]
            inertia = (
                [about] * 3 if isinstance(about, float) else [about[i][i] for i in range(3)]
            )
            bullet.changeDynamics(made[0], -1, mass=given["mass"], localInertiaDiagonal=inertia)
            spin = given["spin"] if isinstance(given["spin"], list) else [0, 0, given["spin"]]
            bullet.resetBaseVelocity(made[0], [*given["velocity"], 0.0][:3], spin)
        return made[0]

    def push(self, body, force, lever):
        """Push at a point for one step."""
        at, turn = bullet.getBasePositionAndOrientation(body)
        point, _ = bullet.multiplyTransforms(at, turn, [*lever, 0.0][:3], [0, 0, 0, 1])
        bullet.applyExternalForce(body, -1, [*force, 0.0][:3], point, bullet.WORLD_FRAME)

    def step(self):
        """Go on by one step."""
        bullet.stepSimulation()

    def pose(self, body, late):
        """Return x, y and angle, or x, y, z and quaternion."""
        at, (a, b, c, w) = bullet.getBasePositionAndOrientation(body)
        speed, spin = bullet.getBaseVelocity(body)
        place = [each + rate * late for each, rate in zip(at, speed)]
        if self.scene["dimensions"] == 3:
            return [*place, w, a, b, c]
        return [*place[:2], angle((w, a, b, c)) + spin[2] * late]


if __name__ == "__main__":
    main(Engine)
