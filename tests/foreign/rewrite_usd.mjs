// Reads a .usda or .usdz with TinyUSDZ and writes as text what it has understood: rewrite_usd.mjs IN OUT.
import { readFileSync, writeFileSync } from "node:fs";

// The package is built for browsers alone, and looks for one when it is loaded.
globalThis.window = {};
process.type = "renderer";
const { default: load } = await import("tinyusdz/tinyusdz.js");

const [from, to] = process.argv.slice(2);
const wasmBinary = readFileSync(new URL("node_modules/tinyusdz/tinyusdz.wasm", import.meta.url));
const usd = new (await load({ wasmBinary })).TinyUSDZLoaderNative();
if (!usd.loadAsLayerFromBinary(readFileSync(from), from)) throw new Error(usd.error());
writeFileSync(to, usd.layerToString());
