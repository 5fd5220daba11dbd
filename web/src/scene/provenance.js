// Provenance: tints each Gaussian by what supports it and hides those with little support. One texel a Gaussian holds the
// color of its class and its support; two uniforms say how strong the tint is and what is hidden, so a change costs nothing.
import {RgbaArray, dyno} from '@sparkjsdev/spark';
import {CLASSES, classOfByte, rgbOf} from '../shared/support_classes.js';

export class Provenance {
  // support: Uint8Array, one byte a Gaussian in the order of the splat, 255 = support 1.
  constructor(mesh, support) {
    const n = mesh.numSplats;
    this.mesh = mesh;
    this.texels = new RgbaArray({array: texelsOf(support, n), count: n});
    this.texels.needsUpdate = true;
    this.tint = dyno.dynoFloat(0);
    this.hideBelow = dyno.dynoFloat(0);
    mesh.objectModifier = dyno.dynoBlock({gsplat: dyno.Gsplat}, {gsplat: dyno.Gsplat}, ({gsplat}) => ({gsplat: this.apply(gsplat)}));
    mesh.updateGenerator();
  }

  apply(gsplat) {
    return new dyno.Dyno({
      inTypes: {gsplat: dyno.Gsplat, texels: this.texels.dyno.type, tint: 'float', hideBelow: 'float'},
      outTypes: {gsplat: dyno.Gsplat},
      inputs: {gsplat, texels: this.texels.dyno, tint: this.tint, hideBelow: this.hideBelow},
      statements: ({inputs, outputs}) => `
        ${outputs.gsplat} = ${inputs.gsplat};
        vec4 supportTexel = texelFetch(${inputs.texels}.texture, splatTexCoord(${inputs.gsplat}.index), 0);
        float brightness = dot(clamp(${inputs.gsplat}.rgba.rgb, 0.0, 1.0), vec3(0.2126, 0.7152, 0.0722));
        vec3 tinted = supportTexel.rgb * (0.5 + 0.7 * brightness);
        ${outputs.gsplat}.rgba.rgb = mix(${inputs.gsplat}.rgba.rgb, tinted, ${inputs.tint});
        if (supportTexel.a + 0.001 < ${inputs.hideBelow}) ${outputs.gsplat}.rgba.a = 0.0;
      `.split('\n'),
    }).outputs.gsplat;
  }

  // tint: 0 = true colors, 1 = colors of the classes; hideBelow: support in [0,1].
  set(tint, hideBelow) {
    this.tint.value = tint;
    this.hideBelow.value = hideBelow;
    this.mesh.updateVersion();
  }

  dispose() {
    this.texels.dispose();
  }
}

function texelsOf(support, n) {
  const colors = CLASSES.map((c) => rgbOf(c.color));
  const out = new Uint8Array(Math.ceil(n / 2048) * 2048 * 4);
  for (let i = 0; i < n; i++) {
    const value = support[i] ?? 255;
    const [r, g, b] = colors[classOfByte(value)];
    out.set([r, g, b, value], 4 * i);
  }
  return out;
}
