// Rapier in the plane. Set up: npm install @dimforge/rapier2d-compat@0.21
import RAPIER from "@dimforge/rapier2d-compat";
import { local, main } from "./files.mjs";

await RAPIER.init();
main({
  name: "Rapier 2D",
  version: RAPIER.version(),
  dimensions: [2],
  settings: {
    documented: ["its defaults: 1/60 s, 4 solver iterations", { step: 1 / 60 }],
    best: ["1/240 s, 20 solver iterations, contact frequency 240 Hz", { step: 1 / 240, sweeps: 20, hertz: 240 }],
  },
  world(scene, settings) {
    const vector = ([x, y]) => ({ x, y });
    const world = new RAPIER.World(vector(scene.gravity));
    world.timestep = settings.step;
    if (settings.sweeps) world.numSolverIterations = settings.sweeps;
    if (settings.hertz) world.integrationParameters.contact_natural_frequency = settings.hertz;
    return {
      // Frictions: their mean.
      add(given) {
        let place = given.fixed ? RAPIER.RigidBodyDesc.fixed() : RAPIER.RigidBodyDesc.dynamic().setCanSleep(false);
        place = place.setTranslation(...(given.centre ?? [0, 0]));
        if (!given.fixed) {
          place = place.setLinvel(...given.velocity).setAngvel(given.spin);
          place = place.setAdditionalMassProperties(given.mass, { x: 0, y: 0 }, given.inertia);
        }
        const body = world.createRigidBody(place);
        for (const polygon of given.polygons) {
          const shape = RAPIER.ColliderDesc.convexPolyline(new Float32Array(local(given, polygon).flat()));
          world.createCollider(shape.setDensity(0).setFriction(scene.friction).setRestitution(0), body);
        }
        return body;
      },
      push(body, force, lever) {
        const [cos, sin] = [Math.cos(body.rotation()), Math.sin(body.rotation())];
        const { x, y } = body.translation();
        const at = { x: x + cos * lever[0] - sin * lever[1], y: y + sin * lever[0] + cos * lever[1] };
        const impulse = { x: force[0] * settings.step, y: force[1] * settings.step };
        body.applyImpulseAtPoint(impulse, at, true);
      },
      step: () => world.step(),
      pose(body, late) {
        const [{ x, y }, { x: u, y: v }] = [body.translation(), body.linvel()];
        return [x + u * late, y + v * late, body.rotation() + body.angvel() * late];
      },
      free: () => world.free(),
    };
  },
});
