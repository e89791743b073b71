// Prints what the validator says of files, as JSON.
const fs = require("fs");
const path = require("path");
const [modules, ...names] = process.argv.slice(2);
const validator = require(path.join(modules, "gltf-validator"));

async function main() {
  const said = [];
  for (const name of names) {
    const report = await validator.validateBytes(new Uint8Array(fs.readFileSync(name)));
    said.push({ ...report.issues, ...report.info });
  }
  console.log(JSON.stringify(said));
}

main();
