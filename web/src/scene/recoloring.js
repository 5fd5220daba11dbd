// Gives each Gaussian the color of a mode (shared/modes.js), and hides those with little support and what is cut off. A texel a
// Gaussian holds what is known of it: its support, its uncertainty, and whether it is a speck. Uniforms say what is shown, so
// a change costs nothing.
import {Vector2, Vector3, Vector4} from 'three';
import {RgbaArray, dyno} from '@sparkjsdev/spark';
import {MODES} from '../shared/modes.js';
import {CLASSES, rgbOf} from '../shared/support_classes.js';

export class Recoloring {
  // marks: {support, uncertainty}, each a Uint8Array with one byte a Gaussian in the order of the splat, 255 = 1 and the
  // largest error shown; or nothing.
  constructor(mesh, marks) {
    this.mesh = mesh;
    this.marks = marks;
    this.array = texelsOf(marks, mesh.numSplats);
    this.texels = new RgbaArray({array: this.array, count: mesh.numSplats});
    this.texels.needsUpdate = true;
    this.mode = dyno.dynoInt(0);
    this.hideBelow = dyno.dynoFloat(0);
    this.nearness = dyno.dynoVec2(new Vector2(0, 1));  // 1 / far, 1 / near
    this.low = dyno.dynoVec3(new Vector3());
    this.high = dyno.dynoVec3(new Vector3());
    this.ball = dyno.dynoVec4(new Vector4());  // center and radius
    this.noSpecks = dyno.dynoBool(false);
    mesh.objectModifier = dyno.dynoBlock({gsplat: dyno.Gsplat}, {gsplat: dyno.Gsplat}, ({gsplat}) => ({gsplat: this.apply(gsplat)}));
    mesh.updateGenerator();
  }

  // In the object's frame, where Spark knows the camera.
  apply(gsplat) {
    const {viewToObject} = this.mesh.context;
    const inputs = {
      gsplat, mode: this.mode, hideBelow: this.hideBelow, range: this.nearness, eye: viewToObject.translate, turn: viewToObject.rotate,
      low: this.low, high: this.high, ball: this.ball, noSpecks: this.noSpecks, texels: this.texels.dyno};
    return new dyno.Dyno({
      inTypes: {
        gsplat: dyno.Gsplat, mode: 'int', hideBelow: 'float', range: 'vec2', eye: 'vec3', turn: 'vec4',
        low: 'vec3', high: 'vec3', ball: 'vec4', noSpecks: 'bool', texels: this.texels.dyno.type},
      outTypes: {gsplat: dyno.Gsplat},
      inputs,
      globals: () => [...MODES.filter((mode) => mode.ramp).map((mode) => rampFunction(mode)), CLASS_FUNCTION],
      statements: ({inputs: i, outputs: o}) => `
        ${o.gsplat} = ${i.gsplat};
        {
          vec3 own = ${i.gsplat}.rgba.rgb;
          vec3 shown = own;
          float brightness = dot(clamp(own, 0.0, 1.0), vec3(0.2126, 0.7152, 0.0722));
          vec4 texel = texelFetch(${i.texels}.texture, splatTexCoord(${i.gsplat}.index), 0);
          vec3 support = classColor(texel.r);
          float uncertainty = texel.g;
          vec3 away = ${i.gsplat}.center - ${i.eye};
          float nearness = (1.0 / max(length(away), 1e-9) - ${i.range}.x) / (${i.range}.y - ${i.range}.x);
          vec3 scales = ${i.gsplat}.scales;
          float least = min(scales.x, min(scales.y, scales.z));
          vec3 axis = quatVec(${i.gsplat}.quaternion, least == scales.z ? vec3(0, 0, 1) : least == scales.y ? vec3(0, 1, 0) : vec3(1, 0, 0));
          vec3 normal = quatVec(vec4(-${i.turn}.xyz, ${i.turn}.w), dot(axis, away) > 0.0 ? -axis : axis) * vec3(1, -1, -1);
          ${MODES.map(({shader}, k) => (shader ? `if (${i.mode} == ${k}) { ${shader} }` : '')).join('\n')}
          ${o.gsplat}.rgba.rgb = shown;
          vec3 at = quatVec(vec4(${glslQuaternion(this.mesh.quaternion)}), ${i.gsplat}.center);
          bool cut = any(lessThan(at, ${i.low})) || any(greaterThan(at, ${i.high})) || distance(at, ${i.ball}.xyz) > ${i.ball}.w;
          if (cut || texel.r + 0.001 < ${i.hideBelow} || (${i.noSpecks} && texel.b > 0.5)) ${o.gsplat}.rgba.a = 0.0;
        }
      `.split('\n'),
    }).outputs.gsplat;
  }

  // id: of a mode; one that needs marks shows true colors without them. hideBelow: support in [0,1].
  set(id, hideBelow) {
    const at = MODES.findIndex((mode) => mode.id === id && (!mode.needs || this.marks[mode.needs]));
    this.mode.value = Math.max(0, at);
    this.hideBelow.value = hideBelow;
    this.mesh.enableViewToObject = this.mode.value > 0;  // the colors follow the camera
    this.mesh.updateVersion();
  }

  // cut: see cut.js; specks: Uint8Array, 1 for a speck, once it is known.
  cut({box, center, radius}, specks) {
    this.low.value.copy(box.min);
    this.high.value.copy(box.max);
    this.ball.value.set(...center.toArray(), radius);
    this.noSpecks.value = Boolean(specks);
    if (specks && specks !== this.specks) {
      this.specks = specks;
      specks.forEach((is, i) => { this.array[4 * i + 2] = 255 * is; });
      this.texels.needsUpdate = true;
    }
    this.mesh.updateVersion();
  }

  // The distances at the ends of the ramp, in scene units.
  setRange({near, far}) {
    this.nearness.value.set(1 / far, 1 / near);
    this.mesh.updateVersion();
  }

  dispose() {
    this.texels.dispose();
  }
}

const glsl = (color) => `vec3(${rgbOf(color).map((v) => (v / 255).toFixed(4)).join(', ')})`;

const glslQuaternion = (q) => q.toArray().map((v) => v.toFixed(6)).join(', ');

// The color of a support's class; a quarter of a byte's step keeps the borders of the classes.
const CLASS_FUNCTION = `
    vec3 classColor(float support) {
      ${CLASSES.map(({from, color}) => `if (support + 0.001 >= ${from.toFixed(4)}) return ${glsl(color)};`).join('\n')}
      return vec3(0.0);
    }`;

function rampFunction({id, ramp: colors}) {
  const stops = colors.map(glsl);
  const last = colors.length - 1;
  return `
    vec3 ${id}Ramp(float value) {
      vec3 stops[${colors.length}] = vec3[](${stops.join(', ')});
      float at = clamp(value, 0.0, 1.0) * ${last}.0;
      int below = min(int(at), ${last - 1});
      return mix(stops[below], stops[below + 1], at - float(below));
    }`;
}

function texelsOf({support, uncertainty}, n) {
  const out = new Uint8Array(Math.ceil(n / 2048) * 2048 * 4);
  for (let i = 0; i < n; i++) out.set([support?.[i] ?? 255, uncertainty?.[i] ?? 255, 0, 255], 4 * i);
  return out;
}
