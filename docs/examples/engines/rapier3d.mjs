// Rapier in space; planar scenes as prisms. Set up: npm install @dimforge/rapier3d-compat@0.21
import RAPIER from "@dimforge/rapier3d-compat";
import { angle, inertia, main, prism } from "./files.mjs";

await RAPIER.init();
main({
  name: "Rapier 3D",
  version: RAPIER.version(),
  dimensions: [2, 3],
  settings: {
    documented: ["its defaults: 1/60 s, 4 solver iterations", { step: 1 / 60 }],
    best: ["1/240 s, 4 solver iterations", { step: 1 / 240 }],
  },
  world(scene, settings) {
    const vector = ([x, y, z = 0]) => ({ x, y, z });
    const planar = scene.dimensions === 2;
    const world = new RAPIER.World(vector(scene.gravity));
    world.timestep = settings.step;
    return {
      // Frictions: their mean.
      add(given) {
        let place = given.fixed ? RAPIER.RigidBodyDesc.fixed() : RAPIER.RigidBodyDesc.dynamic().setCanSleep(false);
        const { x, y, z } = vector(given.centre ?? [0, 0, 0]);
        place = place.setTranslation(x, y, z);
        if (!given.fixed) {
          const speed = vector(given.velocity);
          place = place.setLinvel(speed.x, speed.y, speed.z);
          place = place.setAngvel(vector(planar ? [0, 0, given.spin] : given.spin));
          const [a, b, c] = inertia(given);
          const turn = { x: 0, y: 0, z: 0, w: 1 };
          place = place.setAdditionalMassProperties(given.mass, vector([0, 0, 0]), vector([a, b, c]), turn);
        }
        const body = world.createRigidBody(place);
        for (const shape of given.polygons ?? given.polyhedra) {
          const hull = RAPIER.ColliderDesc.convexHull(new Float32Array(prism(given, shape).flat()));
          world.createCollider(hull.setDensity(0).setFriction(scene.friction).setRestitution(0), body);
        }
        return body;
      },
      push(body, force, lever) {
        const [{ x, y, z }, q, p] = [body.translation(), body.rotation(), vector(lever)];
        // v + 2 w (q x v) + 2 q x (q x v)
        const once = { x: 2 * (q.y * p.z - q.z * p.y), y: 2 * (q.z * p.x - q.x * p.z), z: 2 * (q.x * p.y - q.y * p.x) };
        const at = {
          x: x + p.x + q.w * once.x + q.y * once.z - q.z * once.y,
          y: y + p.y + q.w * once.y + q.z * once.x - q.x * once.z,
          z: z + p.z + q.w * once.z + q.x * once.y - q.y * once.x,
        };
        body.applyImpulseAtPoint(vector(force.map((each) => each * settings.step)), at, true);
      },
      step: () => world.step(),
      pose(body, late) {
        const [{ x, y, z }, { x: u, y: v, z: w }, q] = [body.translation(), body.linvel(), body.rotation()];
        if (planar) return [x + u * late, y + v * late, angle(q) + body.angvel().z * late];
        return [x + u * late, y + v * late, z + w * late, q.w, q.x, q.y, q.z];
      },
      free: () => world.free(),
    };
  },
});
