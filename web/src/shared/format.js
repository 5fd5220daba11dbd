// Numbers for people.
export const number = (value, digits = 0) =>
  Number.isFinite(value) ? value.toLocaleString('en', {minimumFractionDigits: digits, maximumFractionDigits: digits}) : '–';

export const percent = (share, digits = 0) => (Number.isFinite(share) ? `${(100 * share).toFixed(digits)} %` : '–');

export function duration(seconds) {
  if (!Number.isFinite(seconds)) return '–';
  if (seconds < 10) return `${seconds.toFixed(1)} s`;
  if (seconds < 90) return `${Math.round(seconds)} s`;
  const minutes = Math.round(seconds / 60);
  return minutes < 90 ? `${minutes} min` : `${Math.floor(minutes / 60)} h ${minutes % 60} min`;
}

export function bytes(value) {
  if (!Number.isFinite(value)) return '–';
  const units = ['B', 'kB', 'MB', 'GB'];
  let i = 0;
  while (value >= 1000 && i < units.length - 1) { value /= 1000; i++; }
  return `${i ? value.toFixed(1) : value} ${units[i]}`;
}

// A name that every system can store.
export const fileName = (title, ending) => `${(title || 'splat').replace(/[\p{Cc}/\\:*?"<>|]+/gu, '_')}.${ending}`;

// Few digits for any size; for axes and tables of unknown things.
export function short(value) {
  if (!Number.isFinite(value)) return '–';
  const size = Math.abs(value);
  if (size >= 1e5) return value.toLocaleString('en', {notation: 'compact', maximumSignificantDigits: 3});
  if (size >= 100 || Number.isInteger(value)) return number(value);
  return size >= 0.001 || size === 0 ? String(+value.toPrecision(3)) : value.toExponential(1);
}
