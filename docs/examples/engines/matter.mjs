// matter.js. Set up: npm install matter-js@0.20
import Matter from "matter-js";
import { local, main } from "./files.mjs";

const SCALE = 100; // pixels a metre: its bodies and slop are in pixels, its times in ms
// Its friction depends on the unit of mass; its own bodies have 0.001 a square pixel, as 2000 kg a square metre here.
const MASS = 0.001 * SCALE * SCALE / 2000;
const { Bodies, Body, Composite, Engine, Vertices } = Matter;

main({
  name: "matter.js",
  version: "0.20",
  dimensions: [2],
  settings: {
    documented: ["its defaults: 1/60 s, 4 velocity and 6 position iterations, slop 0.05", { step: 1 / 60 }],
    best: ["1/240 s, 20 and 20 iterations, frictionStatic 5", { step: 1 / 240, sweeps: 20, still: 5 }],
  },
  world(scene, settings) {
    const engine = Engine.create({ gravity: { x: 0, y: 0 } });
    if (settings.sweeps) engine.velocityIterations = engine.positionIterations = settings.sweeps;
    const ms = 1000 * settings.step;
    const pulled = [];
    return {
      // Frictions: the lesser. y points down.
      add(given) {
        const parts = given.polygons.map((polygon) => local(given, polygon).map(([x, y]) => ({ x: SCALE * x, y: -SCALE * y })));
        const options = { isStatic: given.fixed, friction: scene.friction, frictionAir: 0, restitution: 0 };
        if (settings.still) options.frictionStatic = settings.still;
        const made = parts.map((part) => {
          const middle = Vertices.centre(Vertices.clockwiseSort(part.map((each) => ({ ...each }))));
          return Bodies.fromVertices(middle.x, middle.y, [part], options);
        });
        const body = made.length > 1 ? Body.create({ ...options, parts: made }) : made[0];
        // What is static has a friction of 1.
        body.parts.forEach((part) => { part.friction = scene.friction; part.frictionStatic = settings.still ?? 0.5; });
        const [x, y] = given.centre ?? [0, 0];
        Body.translate(body, { x: SCALE * x, y: -SCALE * y });
        if (!given.fixed) {
          Body.setMass(body, MASS * given.mass);
          Body.setInertia(body, MASS * given.inertia * SCALE * SCALE);
          // Velocities are by a sixtieth of a second.
          Body.setVelocity(body, { x: (SCALE * given.velocity[0]) / 60, y: (-SCALE * given.velocity[1]) / 60 });
          Body.setAngularVelocity(body, -given.spin / 60);
          pulled.push(body);
        }
        Composite.add(engine.world, body);
        body.first = { x: body.position.x, y: body.position.y, centre: given.centre };
        return body;
      },
      push(body, force, lever) {
        const [cos, sin] = [Math.cos(-body.angle), Math.sin(-body.angle)];
        const at = { x: cos * lever[0] - sin * lever[1], y: sin * lever[0] + cos * lever[1] };
        const place = { x: body.position.x + SCALE * at.x, y: body.position.y - SCALE * at.y };
        Body.applyForce(body, place, { x: (MASS * force[0] * SCALE) / 1e6, y: (-MASS * force[1] * SCALE) / 1e6 });
      },
      step() {
        for (const body of pulled) {
          body.force.x += (body.mass * scene.gravity[0] * SCALE) / 1e6;
          body.force.y -= (body.mass * scene.gravity[1] * SCALE) / 1e6;
        }
        Engine.update(engine, ms);
      },
      pose(body, late) {
        const speed = Body.getVelocity(body);
        const { first } = body;
        const x = first.centre[0] + (body.position.x - first.x) / SCALE + (speed.x * 60 * late) / SCALE;
        const y = first.centre[1] - (body.position.y - first.y) / SCALE - (speed.y * 60 * late) / SCALE;
        return [x, y, -body.angle - Body.getAngularVelocity(body) * 60 * late];
      },
    };
  },
});
