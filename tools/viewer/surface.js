// What a page works out of triangles: normals for shading, and edges. Pure functions on arrays.

/** Faces that meet at a larger angle meet in an edge; as in moseg_core/view/normals.py. */
const CREASE = Math.cos((40 * Math.PI) / 180);
/** Edges within an element, of a voxel, are drawn where it bends. */
const BENT = 0.99;

/** (3 T) normals of the triangles, as long as twice their areas. */
function faceNormals(positions, triangles) {
  const normals = new Float32Array(triangles.length);
  for (let t = 0; t < triangles.length; t += 3) {
    const [a, b, c] = [3 * triangles[t], 3 * triangles[t + 1], 3 * triangles[t + 2]];
    const ux = positions[b] - positions[a];
    const uy = positions[b + 1] - positions[a + 1];
    const uz = positions[b + 2] - positions[a + 2];
    const vx = positions[c] - positions[a];
    const vy = positions[c + 1] - positions[a + 1];
    const vz = positions[c + 2] - positions[a + 2];
    normals[t] = uy * vz - uz * vy;
    normals[t + 1] = uz * vx - ux * vz;
    normals[t + 2] = ux * vy - uy * vx;
  }
  return normals;
}

/** For each vertex the places in `keys` that name it: `places[starts[v]] ... places[starts[v+1]-1]`. */
function placesByVertex(keys, count) {
  const starts = new Uint32Array(count + 1);
  for (const key of keys) starts[key + 1]++;
  for (let v = 0; v < count; v++) starts[v + 1] += starts[v];
  const next = starts.slice(0, count);
  const places = new Uint32Array(keys.length);
  for (let i = 0; i < keys.length; i++) places[next[keys[i]]++] = i;
  return { starts, places };
}

function cosine(normals, s, t) {
  const [a, b] = [3 * s, 3 * t];
  const dot =
    normals[a] * normals[b] + normals[a + 1] * normals[b + 1] + normals[a + 2] * normals[b + 2];
  const lengths =
    Math.hypot(normals[a], normals[a + 1], normals[a + 2]) *
    Math.hypot(normals[b], normals[b + 1], normals[b + 2]);
  return lengths > 0 ? dot / lengths : 1;
}

/**
 * (9 T) a unit normal for each corner of each triangle.
 *
 * The mean, weighted by area, of the triangles around the vertex that bend by less than 40 degrees
 * from the corner's own: smooth surfaces look smooth, and boxes keep their edges.
 */
export function cornerNormals(positions, triangles) {
  const faces = faceNormals(positions, triangles);
  const unit = new Float32Array(faces.length);
  for (let t = 0; t < faces.length; t += 3) {
    const length = Math.hypot(faces[t], faces[t + 1], faces[t + 2]) || 1;
    for (let axis = 0; axis < 3; axis++) unit[t + axis] = faces[t + axis] / length;
  }
  const { starts, places } = placesByVertex(triangles, positions.length / 3);
  const normals = new Float32Array(3 * triangles.length);
  for (let corner = 0; corner < triangles.length; corner++) {
    const own = 3 * Math.floor(corner / 3);
    const [ox, oy, oz] = [unit[own], unit[own + 1], unit[own + 2]];
    const flat = ox === 0 && oy === 0 && oz === 0;
    let [x, y, z] = [0, 0, 0];
    for (let i = starts[triangles[corner]]; i < starts[triangles[corner] + 1]; i++) {
      const other = 3 * Math.floor(places[i] / 3);
      const bend = ox * unit[other] + oy * unit[other + 1] + oz * unit[other + 2];
      if (flat || bend > CREASE) {
        x += faces[other];
        y += faces[other + 1];
        z += faces[other + 2];
      }
    }
    const length = Math.hypot(x, y, z);
    normals[3 * corner] = length > 0 ? x / length : 0;
    normals[3 * corner + 1] = length > 0 ? y / length : 0;
    normals[3 * corner + 2] = length > 0 ? z / length : 1;
  }
  return normals;
}

/**
 * Edges as pairs of vertices, for each label: `boundaries` where two labels meet, which both have,
 * and `wires` where two elements meet or a surface ends.
 */
export function findEdges(positions, triangles, labels, elements, nLabels) {
  const boundaries = Array.from({ length: nLabels }, () => []);
  const wires = Array.from({ length: nLabels }, () => []);
  const faces = faceNormals(positions, triangles);
  // Of the edge that starts at a corner the lower vertex, and the higher one.
  const low = new Uint32Array(triangles.length);
  const high = new Uint32Array(triangles.length);
  for (let corner = 0; corner < triangles.length; corner++) {
    const after = corner % 3 === 2 ? corner - 2 : corner + 1;
    low[corner] = Math.min(triangles[corner], triangles[after]);
    high[corner] = Math.max(triangles[corner], triangles[after]);
  }
  const { starts, places } = placesByVertex(low, positions.length / 3);
  const seen = new Uint8Array(triangles.length);
  for (let vertex = 0; vertex + 1 < starts.length; vertex++) {
    for (let i = starts[vertex]; i < starts[vertex + 1]; i++) {
      if (seen[places[i]] || high[places[i]] === vertex) continue;
      const end = high[places[i]];
      const around = [];
      for (let j = i; j < starts[vertex + 1]; j++) {
        if (high[places[j]] !== end) continue;
        seen[places[j]] = 1;
        around.push(Math.floor(places[j] / 3));
      }
      const [first] = around;
      const meeting = new Set(around.map((t) => labels[t]));
      const several = around.some((t) => elements !== null && elements[t] !== elements[first]);
      const bent = around.some((t) => cosine(faces, first, t) < BENT);
      const drawn = around.length === 1 || elements === null || several || bent;
      for (const label of meeting) {
        if (meeting.size > 1) boundaries[label].push(vertex, end);
        if (drawn) wires[label].push(vertex, end);
      }
    }
  }
  return { boundaries, wires };
}
