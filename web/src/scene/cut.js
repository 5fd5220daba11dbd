// What an export leaves out of the splat, left out of the 3D view; the splat itself stays as it is.
import {Box3, Box3Helper, Color, Vector3} from 'three';

const FAR = 1e30;
const EDGE = 0xffffff;

export class Cut {
  // edits: as the app keeps them, {crop, min_support, remove_outliers}; frame: {center, radius} of what the cameras look at.
  constructor(edits, frame) {
    const numbers = edits.crop?.startsWith('box:') ? edits.crop.slice(4).split(',').map(Number) : [];
    const isBox = numbers.length === 6 && numbers.every(Number.isFinite);
    this.box = isBox ? new Box3(new Vector3(...numbers.slice(0, 3)), new Vector3(...numbers.slice(3)))
      : new Box3(new Vector3(-FAR, -FAR, -FAR), new Vector3(FAR, FAR, FAR));
    const isBall = edits.crop === 'auto';
    this.center = isBall ? frame.center.clone() : new Vector3();
    this.radius = isBall ? frame.radius : FAR;
    this.support = Number(edits.min_support) || 0;
    this.specks = Boolean(edits.remove_outliers);
    if (isBox) this.edges = new Box3Helper(this.box, new Color(EDGE));
  }

  holds(point) {
    return this.box.containsPoint(point) && point.distanceTo(this.center) <= this.radius;
  }
}
