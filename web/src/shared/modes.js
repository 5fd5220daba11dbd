// What the 3D view shows, a row a mode: the panel, the keys and the shader follow from this table.
//   needs    what the splat has to have: 'support' or 'uncertainty'
//   swatches legend of single colors: [{name, color}]; ramp: legend of a range, colors from its lower end, which ID + 'Ramp' maps;
//            ends: texts at its ends, the distances of the view where there are none
//   shader   GLSL that sets `shown` of a Gaussian from (scene/recoloring.js):
//            own (its color), brightness, nearness (0 = the far end of the range, 1 = the near end), uncertainty (0 to 1),
//            normal (its shortest axis, toward the camera; x right, y down, z forward), support (color of its class)
import {PLASMA} from './plasma.js';
import {CLASSES} from './support_classes.js';

// Colors and axes as `oraclegs render --what depth,normals` has them.
const VIRIDIS = ['#440154', '#472c7a', '#3b518b', '#2c718e', '#21908d', '#27ad81', '#5cc863', '#aadc32', '#fde725'];
const DIRECTIONS = [
  {name: 'toward the camera', color: '#808000'}, {name: 'to the right', color: '#ff8080'}, {name: 'to the left', color: '#008080'},
  {name: 'up', color: '#800080'}, {name: 'down', color: '#80ff80'}];

export const MODES = [
  {id: 'color', name: 'color', note: ''},
  {id: 'provenance', name: 'provenance', needs: 'support', swatches: CLASSES,
   note: 'How well photos show each Gaussian. Well seen: by two or more.', shader: 'shown = support * (0.5 + 0.7 * brightness);'},
  {id: 'certainty', name: 'how sure', needs: 'uncertainty', ramp: PLASMA, ends: ['sure', 'may be off by 0.3'],
   note: 'How far colors are expected to be off, black to white being 1: where models that learned from the same photos differ.',
   shader: 'shown = certaintyRamp(uncertainty);'},
  {id: 'depth', name: 'depth', ramp: VIRIDIS, note: 'Distance to the camera, in units of the scene.', shader: 'shown = depthRamp(nearness);'},
  {id: 'normals', name: 'normals', swatches: DIRECTIONS,
   note: 'Where the flat side of each Gaussian faces.', shader: 'shown = 0.5 + 0.5 * normal;'},
];
