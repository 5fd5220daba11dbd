// Classes of support, best first. Colors of Okabe and Ito, which color-blind people can distinguish.
export const CLASSES = [
  {name: 'well seen', from: 0.75, color: '#0072b2'},
  {name: 'seen by one photo', from: 0.5, color: '#56b4e9'},
  {name: 'invented and trusted', from: 0.25, color: '#f0e442'},
  {name: 'weak', from: 0, color: '#d55e00'},
];

export const classOf = (support) => CLASSES.findIndex((c) => support >= c.from);
export const classOfByte = (byte) => classOf((byte + 0.25) / 255);

export function rgbOf(hex) {
  const value = parseInt(hex.slice(1), 16);
  return [value >> 16, (value >> 8) & 255, value & 255];
}

// How many Gaussians are in each class; support: bytes, 255 = support 1.
export function countClasses(support) {
  const histogram = new Uint32Array(256);
  for (const byte of support) histogram[byte]++;
  const counts = CLASSES.map(() => 0);
  histogram.forEach((count, byte) => { counts[classOfByte(byte)] += count; });
  return counts;
}
