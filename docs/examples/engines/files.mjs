// Scenes in, answers out: what adapters in Node have in common.
//
// An engine has `name`, `version`, `settings` (documented and best: words and numbers),
// `dimensions`, and `world(scene, settings)`, which returns `add(body)`, `push(body, force, lever)`,
// `step()`, `pose(body, late)` and `free()`. `node ENGINE.mjs SCENES ANSWERS.jsonl [best]`.
import fs from "node:fs";
import path from "node:path";

function answer(engine, scene, settings) {
  const world = engine.world(scene, settings);
  const all = scene.bodies.map((body) => world.add(body));
  const moving = all.filter((_, at) => !scene.bodies[at].fixed);
  const pushes = scene.pushes.map((push) => {
    const at = scene.bodies.findIndex((body) => body.name === push.body);
    const lever = push.point.map((each, axis) => each - scene.bodies[at].centre[axis]);
    return [all[at], push.force, lever];
  });
  const found = [];
  let steps = 0;
  for (const until of scene.times) {
    for (; steps < Math.round(until / settings.step); steps += 1) {
      for (const [body, force, lever] of pushes) world.push(body, force, lever);
      world.step();
    }
    // The step nearest to that time; from there it goes on with its velocity.
    const late = until - steps * settings.step;
    found.push(moving.map((body) => world.pose(body, late)));
  }
  if (world.free) world.free();
  return found;
}

// Corners of a shape about the centre of mass; a fixed body has it at 0.
export function local(body, shape) {
  return shape.map((corner) => corner.map((each, axis) => each - (body.centre ?? [0, 0, 0])[axis]));
}

// Corners of a polygon's prism about the centre of mass, z out of the plane.
export function prism(body, shape) {
  const corners = local(body, shape);
  if (corners[0].length === 3) return corners;
  const half = body.depth / 2;
  return [-half, half].flatMap((z) => corners.map(([x, y]) => [x, y, z]));
}

export const angle = ({ w, z }) => 2 * Math.atan2(z, w);

// Inertia about x, y and z: of a planar body enough for what stays in its plane.
export function inertia(body) {
  if (typeof body.inertia === "number") return [body.inertia, body.inertia, body.inertia];
  return body.inertia.map((row, axis) => row[axis]);
}

export function main(engine) {
  const [folder, out, kind = "documented"] = process.argv.slice(2);
  const [words, settings] = engine.settings[kind];
  const head = { format: "blocksim answers 1", engine: engine.name, version: engine.version, settings: `${kind}: ${words}` };
  fs.writeFileSync(out, `${JSON.stringify(head)}\n`);
  for (const file of fs.readdirSync(folder).sort()) {
    const scene = JSON.parse(fs.readFileSync(path.join(folder, file), "utf8"));
    if (!engine.dimensions.includes(scene.dimensions)) continue;
    const started = process.cpuUsage();
    const line = { scene: scene.name };
    const poses = answer(engine, scene, settings);
    const { user, system } = process.cpuUsage(started);
    line.seconds = (user + system) / 1e6;
    if (poses.flat(2).every((each) => Math.abs(each) < 1e9)) line.poses = poses;
    else line.verdict = "open";
    fs.appendFileSync(out, `${JSON.stringify(line)}\n`);
  }
}
