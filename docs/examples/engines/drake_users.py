"""Drake, as its users run it. Set up: `pip install drake==1.51.0`."""

import tempfile
from pathlib import Path

import numpy as np
import pydrake.all as drake
from files import angle, main, prism


class Engine:
    """A multibody plant in discrete steps; planar scenes as prisms."""

    NAME, VERSION, DIMENSIONS = "Drake", "1.51.0", (2, 3)
    SETTINGS = {
        "documented": ("its defaults, steps of 1 ms", {"step": 1e-3}),
        "best": ("1 ms, SAP, penetration allowance 1e-5", {"step": 1e-3, "sap": True}),
    }

    def __init__(self, scene, settings):
        self.scene, self.settings = scene, settings
        self.builder = drake.DiagramBuilder()
        self.plant, _ = drake.AddMultibodyPlantSceneGraph(self.builder, settings["step"])
        if "sap" in settings:
            self.plant.set_discrete_contact_approximation(drake.DiscreteContactApproximation.kSap)
            self.plant.set_penetration_allowance(1e-5)
        self.plant.mutable_gravity_field().set_gravity_vector([*scene["gravity"], 0.0][:3])
        self.folder, self.starts, self.count = tempfile.TemporaryDirectory(), {}, 0
        self.simulator = None

    def add(self, given):
        """Add a body; frictions are combined so that equal ones stay."""
        mu = self.scene["friction"]
        friction, moving = drake.CoulombFriction(mu, mu), not given["fixed"]
        if moving:
            about = given["inertia"]
            inertia = np.diag([about] * 3) if isinstance(about, float) else np.array(about)
            unit = drake.UnitInertia(*(np.diag(inertia) / given["mass"]))
            body = self.plant.AddRigidBody(given["name"], drake.SpatialInertia(given["mass"], [0, 0, 0], unit))
            spin = given["spin"] if isinstance(given["spin"], list) else [0, 0, given["spin"]]
            self.starts[given["name"]] = ([*given["centre"], 0.0][:3], spin, [*given["velocity"], 0.0][:3])
        else:
            body = self.plant.world_body()
        for shape in given.get("polygons") or given["polyhedra"]:
            self.count += 1
            path = Path(self.folder.name) / f"{self.count}.obj"
            path.write_text(obj(prism(given, shape)))
            self.plant.RegisterCollisionGeometry(
                body, drake.RigidTransform(), drake.Convex(str(path)), f"shape {self.count}", friction
            )
        return given["name"]

    def _ready(self):
        if self.simulator is not None:
            return
        self.plant.Finalize()
        self.pushes = self.builder.ExportInput(self.plant.get_applied_spatial_force_input_port())
        self.diagram = self.builder.Build()
        self.simulator = drake.Simulator(self.diagram)
        context = self.simulator.get_mutable_context()
        self.inside, self.forces = self.plant.GetMyMutableContextFromRoot(context), []
        for name, (place, spin, speed) in self.starts.items():
            body = self.plant.GetBodyByName(name)
            self.plant.SetFreeBodyPose(self.inside, body, drake.RigidTransform(place))
            self.plant.SetFreeBodySpatialVelocity(self.inside, body, drake.SpatialVelocity(spin, speed))
        self.simulator.Initialize()

    def push(self, name, force, lever):
        """Push at a point for one step."""
        self._ready()
        said = drake.ExternallyAppliedSpatialForce()
        said.body_index = self.plant.GetBodyByName(name).index()
        said.p_BoBq_B = np.array([*lever, 0.0][:3])
        said.F_Bq_W = drake.SpatialForce(np.zeros(3), np.array([*force, 0.0][:3]))
        self.forces.append(said)

    def step(self):
        """Go on by one step."""
        self._ready()
        context = self.simulator.get_mutable_context()
        if self.forces:
            self.diagram.get_input_port(self.pushes).FixValue(context, self.forces)
            self.forces = []
        self.simulator.AdvanceTo(context.get_time() + self.settings["step"])

    def pose(self, name, late):
        """Return x, y and angle, or x, y, z and quaternion."""
        self._ready()
        body = self.plant.GetBodyByName(name)
        pose = self.plant.EvalBodyPoseInWorld(self.inside, body)
        speed = self.plant.EvalBodySpatialVelocityInWorld(self.inside, body)
        place, turn = pose.translation() + late * speed.translational(), pose.rotation().ToQuaternion().wxyz()
        if self.scene["dimensions"] == 3:
            return [*place.tolist(), *turn.tolist()]
        return [*place[:2].tolist(), angle(turn.tolist()) + late * float(speed.rotational()[2])]


def obj(corners):
    """Return corners as a file of a mesh; Drake takes their hull, whatever the faces."""
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in corners]
    return "\n".join([*lines, *(f"f 1 {at} {at + 1}" for at in range(2, len(corners)))])


if __name__ == "__main__":
    main(Engine)
