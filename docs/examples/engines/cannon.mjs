// cannon-es; planar scenes as prisms, kept in their plane. Set up: npm install cannon-es@0.20
import * as CANNON from "cannon-es";
import { angle, inertia, main, prism } from "./files.mjs";

const vector = ([x, y, z = 0]) => new CANNON.Vec3(x, y, z);

// Faces of a prism of n corners, counter-clockwise seen from outside.
function faces(n) {
  const ring = [...Array(n).keys()];
  return [ring.toReversed(), ring.map((each) => each + n), ...ring.map((at) => [at, (at + 1) % n, ((at + 1) % n) + n, at + n])];
}

main({
  name: "cannon-es",
  version: "0.20",
  dimensions: [2],
  settings: {
    documented: ["its defaults: 1/60 s, 10 iterations, stiffness 1e7, relaxation 3", { step: 1 / 60 }],
    best: ["1/480 s, 100 iterations, tolerance 0, stiffness 1e9", { step: 1 / 480, sweeps: 100, stiffness: 1e9 }],
  },
  world(scene, settings) {
    const world = new CANNON.World({ gravity: vector(scene.gravity) });
    world.defaultContactMaterial.friction = scene.friction;
    world.defaultContactMaterial.restitution = 0;
    if (settings.sweeps) {
      world.solver.iterations = settings.sweeps;
      world.solver.tolerance = 0;
      world.defaultContactMaterial.contactEquationStiffness = settings.stiffness;
      world.defaultContactMaterial.frictionEquationStiffness = settings.stiffness;
    }
    return {
      add(given) {
        const body = new CANNON.Body({ mass: given.fixed ? 0 : given.mass, position: vector(given.centre ?? [0, 0]) });
        body.linearDamping = body.angularDamping = 0;
        for (const polygon of given.polygons) {
          const vertices = prism(given, polygon).map(vector);
          body.addShape(new CANNON.ConvexPolyhedron({ vertices, faces: faces(polygon.length) }));
        }
        if (!given.fixed) {
          body.velocity.copy(vector(given.velocity));
          body.angularVelocity.set(0, 0, given.spin);
          body.linearFactor.set(1, 1, 0);
          body.angularFactor.set(0, 0, 1);
          body.inertia.copy(vector(inertia(given)));
          body.invInertia.set(...inertia(given).map((each) => 1 / each));
          body.updateInertiaWorld(true);
        }
        world.addBody(body);
        return body;
      },
      push: (body, force, lever) => body.applyForce(vector(force), body.quaternion.vmult(vector(lever))),
      step: () => world.step(settings.step),
      pose(body, late) {
        const { position: at, velocity: speed } = body;
        return [at.x + speed.x * late, at.y + speed.y * late, angle(body.quaternion) + body.angularVelocity.z * late];
      },
    };
  },
});
