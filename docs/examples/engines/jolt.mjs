// Jolt; planar scenes as prisms, kept in their plane. Set up: npm install jolt-physics@1.1
import initJolt from "jolt-physics";
import { angle, inertia, main, prism } from "./files.mjs";

const Jolt = await initJolt();
const settings = new Jolt.JoltSettings();
const filter = new Jolt.ObjectLayerPairFilterTable(2);
filter.EnableCollision(0, 1);
filter.EnableCollision(1, 1);
const layers = new Jolt.BroadPhaseLayerInterfaceTable(2, 2);
layers.MapObjectToBroadPhaseLayer(0, new Jolt.BroadPhaseLayer(0));
layers.MapObjectToBroadPhaseLayer(1, new Jolt.BroadPhaseLayer(1));
settings.mObjectLayerPairFilter = filter;
settings.mBroadPhaseLayerInterface = layers;
settings.mObjectVsBroadPhaseLayerFilter = new Jolt.ObjectVsBroadPhaseLayerFilterTable(layers, 2, filter, 2);
const jolt = new Jolt.JoltInterface(settings);
const system = jolt.GetPhysicsSystem();
const bodies = system.GetBodyInterface();

main({
  name: "Jolt",
  version: "jolt-physics 1.1",
  dimensions: [2, 3],
  settings: {
    documented: ["its defaults: 1/60 s, 10 velocity and 2 position steps", { step: 1 / 60, sweeps: [10, 2] }],
    best: ["1/240 s, 50 and 10 steps, penetration slop 1e-4, convex radius 0", { step: 1 / 240, sweeps: [50, 10], fine: true }],
  },
  world(scene, chosen) {
    const vector = ([x, y, z = 0]) => new Jolt.Vec3(x, y, z);
    const planar = scene.dimensions === 2;
    const physics = system.GetPhysicsSettings();
    [physics.mNumVelocitySteps, physics.mNumPositionSteps] = chosen.sweeps;
    if (chosen.fine) physics.mPenetrationSlop = 1e-4;
    system.SetPhysicsSettings(physics);
    system.SetGravity(vector(scene.gravity));
    const made = [];
    return {
      // Frictions: the root of their product.
      add(given) {
        const compound = new Jolt.StaticCompoundShapeSettings();
        const none = new Jolt.Vec3(0, 0, 0);
        const straight = new Jolt.Quat(0, 0, 0, 1);
        for (const shape of given.polygons ?? given.polyhedra) {
          const hull = new Jolt.ConvexHullShapeSettings();
          for (const corner of prism(given, shape)) hull.mPoints.push_back(vector(corner));
          if (chosen.fine) hull.mMaxConvexRadius = 0;
          // A hull's place is its centre of mass, which of homogeneous bodies is the body's.
          compound.AddShape(none, straight, hull, 0);
        }
        const [x, y, z = 0] = given.centre ?? [0, 0, 0];
        const kind = given.fixed ? Jolt.EMotionType_Static : Jolt.EMotionType_Dynamic;
        const place = new Jolt.BodyCreationSettings(compound.Create().Get(), new Jolt.RVec3(x, y, z), straight, kind, given.fixed ? 0 : 1);
        place.mFriction = scene.friction;
        place.mRestitution = place.mLinearDamping = place.mAngularDamping = 0;
        place.mAllowSleeping = false;
        if (!given.fixed) {
          place.mOverrideMassProperties = Jolt.EOverrideMassProperties_MassAndInertiaProvided;
          place.mMassPropertiesOverride.mMass = given.mass;
          const [a, b, c] = inertia(given);
          const matrix = new Jolt.Mat44();
          place.mMassPropertiesOverride.mInertia = matrix.sScaleVec3(vector([a, b, c]));
          if (planar) place.mAllowedDOFs = Jolt.EAllowedDOFs_Plane2D;
        }
        const body = bodies.CreateBody(place);
        bodies.AddBody(body.GetID(), Jolt.EActivation_Activate);
        if (!given.fixed) {
          body.SetLinearVelocity(vector(given.velocity));
          body.SetAngularVelocity(vector(planar ? [0, 0, given.spin] : given.spin));
        }
        made.push(body);
        return body;
      },
      push(body, force, lever) {
        const at = body.GetCenterOfMassPosition();
        const turned = body.GetRotation().MulVec3(vector(lever));
        const point = new Jolt.RVec3(at.GetX() + turned.GetX(), at.GetY() + turned.GetY(), at.GetZ() + turned.GetZ());
        bodies.AddForce(body.GetID(), vector(force), point, Jolt.EActivation_Activate);
      },
      step: () => jolt.Step(chosen.step, 1),
      pose(body, late) {
        const [at, speed, q] = [body.GetCenterOfMassPosition(), body.GetLinearVelocity(), body.GetRotation()];
        const place = [at.GetX() + speed.GetX() * late, at.GetY() + speed.GetY() * late, at.GetZ() + speed.GetZ() * late];
        if (!planar) return [...place, q.GetW(), q.GetX(), q.GetY(), q.GetZ()];
        const turn = angle({ w: q.GetW(), z: q.GetZ() });
        return [place[0], place[1], turn + body.GetAngularVelocity().GetZ() * late];
      },
      free() {
        for (const body of made) {
          bodies.RemoveBody(body.GetID());
          bodies.DestroyBody(body.GetID());
        }
      },
    };
  },
});
