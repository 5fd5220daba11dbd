// The 3D part of the report, which unpacks it when it is asked for.
import {SplatScene} from './scene.js';
globalThis.OracleGSScene = {SplatScene};
