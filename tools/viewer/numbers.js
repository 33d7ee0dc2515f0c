// How numbers are written: for people, and for a command line.

const PLAIN = new Intl.NumberFormat("en", { maximumSignificantDigits: 4 });
const WHOLE = new Intl.NumberFormat("en");

/** A measured number with four digits; powers of ten where it would be long. */
export function short(value) {
  const size = Math.abs(value);
  if (size !== 0 && (size < 1e-3 || size >= 1e6)) return value.toExponential(2).replace("e+", "e");
  return PLAIN.format(value);
}

export function whole(value) {
  return WHOLE.format(value);
}

/** A share of 0 to 1 as people read it. */
export function percent(share) {
  if (share > 0 && share < 0.001) return "<0.1 %";
  return `${(100 * share).toFixed(1)} %`;
}

/** A coordinate to a millionth of the size of the shape, as Python reads it. */
export function coordinate(value, size) {
  if (value === 0) return "0";
  const digits = 6 + Math.ceil(Math.log10(Math.abs(value) / size));
  return String(Number(value.toPrecision(Math.min(17, Math.max(1, digits)))));
}

/** A word as a POSIX shell takes it, whatever is in it. */
export function quoted(word) {
  return `'${word.replaceAll("'", "'\\''")}'`;
}
