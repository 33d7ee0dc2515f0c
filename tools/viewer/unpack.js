// The data of a page, as moseg_core/view/page/document.py wrote them, as arrays.

const ARRAYS = { u1: Uint8Array, u2: Uint16Array, u4: Uint32Array };

/** An array of numbers from its type and its bytes in base64, least byte first. */
export function unpackArray({ type, data }) {
  const text = atob(data);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);
  return new ARRAYS[type](bytes.buffer);
}

/**
 * The geometry in scene coordinates: the middle of the bounding box is the origin, its diagonal 1.
 *
 * Positions are numbers of 16 bits within the bounding box. `toModel` leads back to the user's
 * coordinates, in double precision.
 */
export function unpackGeometry(packed) {
  const { low, size } = packed.frame;
  const diagonal = Math.hypot(...size) || 1;
  const middle = low.map((least, axis) => least + size[axis] / 2);
  const steps = unpackArray(packed.positions);
  const positions = new Float32Array(steps.length);
  for (let i = 0; i < steps.length; i++) {
    positions[i] = ((steps[i] / 65535 - 0.5) * size[i % 3]) / diagonal;
  }
  return {
    positions,
    triangles: packed.triangles ? unpackArray(packed.triangles) : null,
    labels: unpackArray(packed.labels),
    elements: packed.elements ? unpackArray(packed.elements) : null,
    // Of points only; those of triangles are worked out.
    normals: packed.normals ? Float32Array.from(unpackArray(packed.normals), (x) => x / 127.5 - 1) : null,
    pointSize: (packed.point_size ?? 0) / diagonal,
    toModel: (place) => place.map((x, axis) => x * diagonal + middle[axis]),
    toScene: (place) => place.map((x, axis) => (x - middle[axis]) / diagonal),
  };
}
