"""PhysX on the processor, through SAPIEN. Set up: `pip install sapien==3.0.3`."""

import numpy as np
import sapien
from files import angle, main, prism
from sapien import physx


class Engine:
    """A scene of SAPIEN; planar scenes as prisms."""

    NAME, VERSION, DIMENSIONS = "PhysX 5", f"sapien {sapien.__version__}", (2, 3)
    SETTINGS = {
        "documented": ("SAPIEN's defaults: 1/100 s, 10 and 1 iterations", {"step": 0.01}),
        "best": ("1/240 s, 30 and 1 iterations", {"step": 1 / 240, "sweeps": (30, 1)}),
    }

    def __init__(self, scene, settings):
        self.scene = scene
        config = physx.PhysxSceneConfig()
        config.gravity = np.array([*scene["gravity"], 0.0][:3], dtype=np.float32)
        physx.set_scene_config(config)
        bodies = physx.PhysxBodyConfig()
        bodies.sleep_threshold = 0.0
        if "sweeps" in settings:
            bodies.solver_position_iterations, bodies.solver_velocity_iterations = settings[
                "sweeps"
            ]
        physx.set_body_config(bodies)
        self.system = physx.PhysxCpuSystem()
        self.system.set_timestep(settings["step"])
        self.world = sapien.Scene([self.system])
        self.step_s = settings["step"]

    def add(self, given):
        """Add a body; frictions are averaged."""
        mu = self.scene["friction"]
        material = physx.PhysxMaterial(mu, mu, 0.0)
        kind = (
            physx.PhysxRigidStaticComponent
            if given["fixed"]
            else physx.PhysxRigidDynamicComponent
        )
        body = kind()
        for shape in given.get("polygons") or given["polyhedra"]:
            corners = np.array(prism(given, shape), dtype=np.float32)
            hull = physx.PhysxCollisionShapeConvexMesh(
                vertices=corners, scale=[1, 1, 1], material=material
            )
            body.attach(hull)
        entity = sapien.Entity()
        entity.add_component(body)
        entity.set_pose(sapien.Pose([*given.get("centre", [0.0, 0.0]), 0.0][:3]))
        if not given["fixed"]:
            about = given["inertia"]
            body.mass, body.cmass_local_pose = given["mass"], sapien.Pose()
            body.inertia = (
                [about] * 3 if isinstance(about, float) else [about[i][i] for i in range(3)]
            )
            body.linear_damping = body.angular_damping = 0.0
            body.linear_velocity = [*given["velocity"], 0.0][:3]
            spin = given["spin"]
            body.angular_velocity = spin if isinstance(spin, list) else [0, 0, spin]
        self.world.add_entity(entity)
        return body

    def push(self, body, force, lever):
        """Push at a point for one step."""
        pose = body.entity.pose
        point = (pose * sapien.Pose([*lever, 0.0][:3])).p
        body.add_force_at_point(np.array([*force, 0.0][:3], np.float32), point)

    def step(self):
        """Go on by one step."""
        self.system.step()

    def pose(self, body, late):
        """Return x, y and angle, or x, y, z and quaternion."""
        pose = body.entity.pose
        place = (pose.p + late * body.linear_velocity).tolist()
        if self.scene["dimensions"] == 3:
            return [*place, *pose.q.tolist()]
        return [*place[:2], angle(pose.q.tolist()) + late * float(body.angular_velocity[2])]


if __name__ == "__main__":
    main(Engine)
