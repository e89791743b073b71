"""MuJoCo, as its users run it, from the suite's MJCF. Set up: `pip install mujoco==4.0.0`."""

import mujoco
from files import main, prism


class Engine:
    """A model and its data."""

    NAME, VERSION, DIMENSIONS = "MuJoCo", mujoco.__version__, (2, 3)
    SETTINGS = {
        "documented": ("its defaults: 2 ms, solref 0.02 1, pyramidal cone", {"step": 0.002}),
        "best": (
            "2 ms, solref 0.004 1, solimp 0.99 0.9999 0.001, elliptic cone, impratio 10",
            {"step": 0.002, "best": True},
        ),
    }

    def __init__(self, scene, settings):
        self.spec, self.settings, self.scene = mujoco.MjSpec(), settings, scene
        option = self.spec.option
        option.timestep = settings["step"]
        option.gravity = [*scene["gravity"], 0.0][:3]
        if "best" in settings:
            option.cone, option.impratio = mujoco.mjtCone.mjCONE_ELLIPTIC, 10
        self.data, self.model, self.speeds = None, None, {}

    def add(self, given):
        """Add a body; MuJoCo takes the larger of two frictions."""
        name, planar = given["name"], self.scene["dimensions"] == 2
        middle = given.get("centre", [0.0, 0.0, 0.0])
        body = self.spec.worldbody.add_body(name=name, pos=[*middle, 0.0][:3])
        if not given["fixed"]:
            body.explicitinertial, body.mass, body.ipos = True, given["mass"], [0, 0, 0]
            if planar:
                body.inertia = [given["inertia"]] * 3
                for axis, kind in ((0, "SLIDE"), (1, "SLIDE"), (2, "HINGE")):
                    joint = body.add_joint(
                        name=f"{name} {axis}", type=getattr(mujoco.mjtJoint, f"mjJNT_{kind}")
                    )
                    joint.axis = [float(axis == each) for each in range(3)]
                self.speeds[name] = [*given["velocity"], given["spin"]]
            else:
                (a, b, c), (_, d, e), (_, _, f) = given["inertia"]
                body.fullinertia = [a, d, f, b, c, e]
                body.add_freejoint(name=f"{name} 0")
                self.speeds[name] = [*given["velocity"], *given["spin"]]
        for part, shape in enumerate(given.get("polygons") or given["polyhedra"]):
            mesh = self.spec.add_mesh(name=f"{name} {part}")
            mesh.uservert = [each for corner in prism(given, shape) for each in corner]
            geom = body.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname=mesh.name)
            geom.friction = [self.scene["friction"], 0, 0]
            if "best" in self.settings:
                geom.solref[:2], geom.solimp[:3] = [0.004, 1], [0.99, 0.9999, 0.001]
        return name

    def _ready(self):
        if self.model is None:
            self.model = self.spec.compile()
            self.data = mujoco.MjData(self.model)
            for name, speed in self.speeds.items():
                at = self.model.joint(f"{name} 0").dofadr[0]
                self.data.qvel[at : at + len(speed)] = speed
            mujoco.mj_forward(self.model, self.data)

    def push(self, name, force, lever):
        """Push at a point for one step."""
        self._ready()
        body = self.data.body(name)
        at = body.xmat.reshape(3, 3) @ [*lever, 0.0][:3]
        force = [*force, 0.0][:3]
        body.xfrc_applied[:] = [
            *force,
            at[1] * force[2] - at[2] * force[1],
            at[2] * force[0] - at[0] * force[2],
            at[0] * force[1] - at[1] * force[0],
        ]

    def step(self):
        """Go on by one step."""
        self._ready()
        mujoco.mj_step(self.model, self.data)

    def pose(self, name, late):
        """Return x, y and angle, or x, y, z and quaternion."""
        self._ready()
        body = self.data.body(name)
        if self.scene["dimensions"] == 3:
            return [*body.xpos.tolist(), *body.xquat.tolist()]
        at = self.model.joint(f"{name} 0").dofadr[0]
        speed = self.data.qvel[at : at + 3]
        turn = float(self.data.qpos[self.model.joint(f"{name} 2").qposadr[0]])
        x, y = body.xpos[:2] + late * speed[:2]
        return [float(x), float(y), turn + late * float(speed[2])]


if __name__ == "__main__":
    main(Engine)
