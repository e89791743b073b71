// Box2D 3, as WebAssembly. Set up: npm install box2d3-wasm@5.2
import Box2DFactory from "box2d3-wasm";
import { local, main } from "./files.mjs";

const box = await Box2DFactory();
const vector = ([x, y]) => new box.b2Vec2(x, y);

main({
  name: "Box2D 3",
  version: "box2d3-wasm 5.2",
  dimensions: [2],
  settings: {
    documented: ["1/60 s, 4 sub-steps", { step: 1 / 60, parts: 4 }],
    best: ["1/240 s, 32 sub-steps, contact hertz 480", { step: 1 / 240, parts: 32, hertz: 480 }],
  },
  world(scene, settings) {
    const said = box.b2DefaultWorldDef();
    said.gravity = vector(scene.gravity);
    said.enableSleep = false;
    if (settings.hertz) said.contactHertz = settings.hertz;
    const world = box.b2CreateWorld(said);
    return {
      // Frictions: the root of their product.
      add(given) {
        const place = box.b2DefaultBodyDef();
        place.type = given.fixed ? box.b2BodyType.b2_staticBody : box.b2BodyType.b2_dynamicBody;
        place.position = vector(given.centre ?? [0, 0]);
        if (!given.fixed) {
          place.linearVelocity = vector(given.velocity);
          place.angularVelocity = given.spin;
        }
        const body = box.b2CreateBody(world, place);
        for (const polygon of given.polygons) {
          const shape = box.b2DefaultShapeDef();
          shape.density = 1;
          shape.material.friction = scene.friction;
          shape.material.restitution = 0;
          const hull = box.b2ComputeHull(local(given, polygon).map(vector));
          box.b2CreatePolygonShape(body, shape, box.b2MakePolygon(hull, 0));
        }
        if (!given.fixed) {
          const mass = new box.b2MassData();
          mass.mass = given.mass;
          mass.center = vector([0, 0]);
          mass.rotationalInertia = given.inertia;
          box.b2Body_SetMassData(body, mass);
        }
        return body;
      },
      push: (body, force, lever) =>
        box.b2Body_ApplyForce(body, vector(force), box.b2Body_GetWorldPoint(body, vector(lever)), true),
      step: () => box.b2World_Step(world, settings.step, settings.parts),
      pose(body, late) {
        const [{ x, y }, { x: u, y: v }] = [box.b2Body_GetWorldCenterOfMass(body), box.b2Body_GetLinearVelocity(body)];
        const angle = box.b2Rot_GetAngle(box.b2Body_GetRotation(body));
        return [x + u * late, y + v * late, angle + box.b2Body_GetAngularVelocity(body) * late];
      },
      free: () => box.b2DestroyWorld(world),
    };
  },
});
