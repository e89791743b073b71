// planck.js, Box2D 2.3 in JavaScript. Set up: npm install planck@1.5
import * as planck from "planck";
import { local, main } from "./files.mjs";

main({
  name: "planck.js",
  version: "1.5",
  dimensions: [2],
  settings: {
    documented: ["8 velocity and 3 position iterations, 1/60 s", { step: 1 / 60, sweeps: [8, 3] }],
    best: ["20 and 10 iterations, 1/240 s, linearSlop 5e-4", { step: 1 / 240, sweeps: [20, 10], slop: 5e-4 }],
  },
  world(scene, settings) {
    const vector = ([x, y]) => planck.Vec2(x, y);
    if (settings.slop) planck.Settings.linearSlop = settings.slop;
    const world = new planck.World({ gravity: vector(scene.gravity), allowSleep: false });
    return {
      // Frictions: the root of their product.
      add(given) {
        const place = { position: vector(given.centre ?? [0, 0]), type: given.fixed ? "static" : "dynamic" };
        const body = world.createBody(place);
        for (const polygon of given.polygons) {
          const shape = new planck.Polygon(local(given, polygon).map(vector));
          body.createFixture(shape, { density: 1, friction: scene.friction, restitution: 0 });
        }
        if (!given.fixed) {
          body.setMassData({ mass: given.mass, center: planck.Vec2(0, 0), I: given.inertia });
          body.setLinearVelocity(vector(given.velocity));
          body.setAngularVelocity(given.spin);
        }
        return body;
      },
      push: (body, force, lever) => body.applyForce(vector(force), body.getWorldPoint(vector(lever)), true),
      step: () => world.step(settings.step, ...settings.sweeps),
      pose(body, late) {
        const { x, y } = body.getWorldCenter();
        const { x: u, y: v } = body.getLinearVelocity();
        return [x + u * late, y + v * late, body.getAngle() + body.getAngularVelocity() * late];
      },
    };
  },
});
