"""Drake, as its users run it. Set up: `pip install drake==1.51.0`."""

import numpy as np
import pydrake.all as drake
from files import angle, main, prism


class Engine:
    """A multibody plant in discrete steps; planar scenes as prisms."""

    NAME, VERSION, DIMENSIONS = "Drake", "1.51.0", (2, 3)
    SETTINGS = {
        "documented": ("5 ms, contact at points", {"step": 5e-3}),
        "best": ("5 ms, SAP, hydroelastic surfaces, 1e11 Pa", {"step": 5e-3, "modulus": 1e11}),
    }

    def __init__(self, scene, settings):
        self.scene, self.step_s = scene, settings["step"]
        self.builder = drake.DiagramBuilder()
        self.plant, graph = drake.AddMultibodyPlantSceneGraph(self.builder, self.step_s)
        if "modulus" in settings:
            sap = drake.DiscreteContactApproximation.kSap
            self.plant.set_discrete_contact_approximation(sap)
            contact = drake.DefaultProximityProperties(compliance_type="compliant")
            contact.hydroelastic_modulus = settings["modulus"]
            graph.set_config(drake.SceneGraphConfig(default_proximity_properties=contact))
        self.plant.mutable_gravity_field().set_gravity_vector(spatial(scene["gravity"]))
        self.given, self.forces, self.simulator = [], [], None

    def add(self, given):
        """Add a body; frictions are combined so that equal ones stay."""
        mu, name, body = self.scene["friction"], given["name"], self.plant.world_body()
        if not given["fixed"]:
            about = np.array(given["inertia"])
            moments = np.diag(about) if about.ndim else np.full(3, about)
            unit = drake.UnitInertia(*(moments / given["mass"]))
            inertia = drake.SpatialInertia(given["mass"], [0, 0, 0], unit)
            body = self.plant.AddRigidBody(name, inertia)
            self.given.append(given)
        place, friction = drake.RigidTransform(), drake.CoulombFriction(mu, mu)
        for at, shape in enumerate(given.get("polygons") or given["polyhedra"]):
            hull = drake.Convex(points=np.transpose(prism(given, shape)), label=name)
            self.plant.RegisterCollisionGeometry(body, place, hull, f"{name} {at}", friction)
        return name

    def _ready(self):
        self.plant.Finalize()
        port = self.plant.get_applied_spatial_force_input_port()
        self.pushes = self.builder.ExportInput(port)
        self.diagram = self.builder.Build()
        self.simulator = drake.Simulator(self.diagram)
        self.context = self.simulator.get_mutable_context()
        self.inside = self.plant.GetMyMutableContextFromRoot(self.context)
        for given in self.given:
            body = self.plant.GetBodyByName(given["name"])
            place = drake.RigidTransform(spatial(given["centre"]))
            self.plant.SetFreeBodyPose(self.inside, body, place)
            spin = given["spin"] if self.scene["dimensions"] == 3 else [0, 0, given["spin"]]
            speed = drake.SpatialVelocity(spin, spatial(given["velocity"]))
            self.plant.SetFreeBodySpatialVelocity(self.inside, body, speed)
        self.simulator.Initialize()

    def push(self, name, force, lever):
        """Push at a point for one step."""
        self.simulator or self._ready()
        said = drake.ExternallyAppliedSpatialForce()
        said.body_index = self.plant.GetBodyByName(name).index()
        said.p_BoBq_B = np.array(spatial(lever))
        said.F_Bq_W = drake.SpatialForce([0, 0, 0], spatial(force))
        self.forces.append(said)

    def step(self):
        """Go on by one step."""
        self.simulator or self._ready()
        if self.forces:
            self.diagram.get_input_port(self.pushes).FixValue(self.context, self.forces)
            self.forces = []
        self.simulator.AdvanceTo(self.context.get_time() + self.step_s)

    def pose(self, name, late):
        """Return x, y and angle, or x, y, z and quaternion."""
        self.simulator or self._ready()
        body = self.plant.GetBodyByName(name)
        pose = self.plant.EvalBodyPoseInWorld(self.inside, body)
        speed = self.plant.EvalBodySpatialVelocityInWorld(self.inside, body)
        place = (pose.translation() + late * speed.translational()).tolist()
        turn = pose.rotation().ToQuaternion().wxyz().tolist()
        if self.scene["dimensions"] == 3:
            return [*place, *turn]
        return [*place[:2], angle(turn) + late * float(speed.rotational()[2])]


def spatial(vector):
    """Return a vector of the plane, or in space, as one in space."""
    return [*vector, 0.0][:3]


if __name__ == "__main__":
    main(Engine)
