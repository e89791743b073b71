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
  dimensions: [2, 3],
  settings: {
    documented: ["its defaults: 1/60 s, 10 iterations, stiffness 1e7, relaxation 3", { step: 1 / 60 }],
    best: ["1/60 s, 50 iterations, tolerance 0, stiffness 1e9", { step: 1 / 60, sweeps: 50, stiffness: 1e9 }],
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
        // Its hulls have to contain their origin, so each has its own.
        const shapes = given.polygons ?? given.polyhedra;
        given.centre ??= shapes[0][0].map(() => 0);
        const body = new CANNON.Body({ mass: given.fixed ? 0 : given.mass, position: vector(given.centre) });
        body.linearDamping = body.angularDamping = 0;
        shapes.forEach((shape, at) => {
          const corners = prism(given, shape);
          const middle = [0, 1, 2].map((axis) => corners.reduce((sum, each) => sum + each[axis] / corners.length, 0));
          const vertices = corners.map((corner) => vector(corner.map((each, axis) => each - middle[axis])));
          const hull = new CANNON.ConvexPolyhedron({ vertices, faces: given.faces?.[at] ?? faces(shape.length) });
          body.addShape(hull, vector(middle));
        });
        if (!given.fixed) {
          body.velocity.copy(vector(given.velocity));
          body.angularVelocity.set(...(given.spin.length ? given.spin : [0, 0, given.spin]));
          if (given.polygons) {
            body.linearFactor.set(1, 1, 0);
            body.angularFactor.set(0, 0, 1);
          }
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
        const { position: at, velocity: speed, quaternion: q } = body;
        if (scene.dimensions === 3) return [at.x, at.y, at.z, q.w, q.x, q.y, q.z];
        return [at.x + speed.x * late, at.y + speed.y * late, angle(q) + body.angularVelocity.z * late];
      },
    };
  },
});
