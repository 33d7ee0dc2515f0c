// One part in the scene: its piece of the surface, the lines on it, and its twin to be picked by.

import {
  BufferAttribute,
  BufferGeometry,
  Color,
  DoubleSide,
  Group,
  LineSegments,
  Mesh,
  MeshBasicMaterial,
  MeshPhongMaterial,
  Points,
  Vector3,
} from "three";
import { LineSegments2 } from "three/addons/lines/LineSegments2.js";
import { LineSegmentsGeometry } from "three/addons/lines/LineSegmentsGeometry.js";

import { pointMaterial } from "./points.js";

const GHOST = 0x8b95a5;
/** Surfaces lie a little behind the lines that are drawn on them. */
const BEHIND = { polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 };

export class Part {
  /**
   * @param k its number
   * @param members the triangles or points that it has
   * @param geometry from unpackGeometry
   * @param normals of the corners of triangles, or of points
   * @param pixels, cssPixels uniforms: how many of them a unit has at a distance of 1
   */
  constructor(k, { members, geometry, normals, color, pixels, cssPixels }) {
    const { positions, triangles, pointSize: size } = geometry;
    const number = new Color().setRGB(((k + 1) >> 8) / 255, ((k + 1) & 255) / 255, 0);
    const buffer = new BufferGeometry();
    const attribute = (name, values) => buffer.setAttribute(name, new BufferAttribute(values, 3));
    attribute("position", gather(positions, members, triangles));
    if (triangles) {
      attribute("normal", cornersOf(normals, members));
      this.solid = new MeshPhongMaterial({
        ...BEHIND, color, side: DoubleSide, specular: 0x161616, shininess: 28,
      });
      this.ghost = new MeshPhongMaterial({
        ...BEHIND, color: GHOST, side: DoubleSide, transparent: true, opacity: 0.1, depthWrite: false,
      });
      this.surface = new Mesh(buffer, this.solid);
      this.twin = new Mesh(buffer, new MeshBasicMaterial({ color: number, side: DoubleSide }));
    } else {
      attribute("normal", gather(normals, members, null));
      const plain = pointMaterial({ color: number, size, pixels: cssPixels, plain: true });
      this.solid = pointMaterial({ color, size, pixels });
      this.ghost = pointMaterial({ color: GHOST, size, pixels, opacity: 0.07 });
      this.surface = new Points(buffer, this.solid);
      this.twin = new Points(buffer, plain);
    }
    this.k = k;
    this.members = members;
    this.lines = {};
    this.group = new Group().add(this.surface);
    this.twin.matrixAutoUpdate = false;
    Object.assign(this, middleOf(buffer.attributes.position.array, triangles !== null));
  }

  /** Draw lines of a kind: wide ones, `ends` of which are (3 n) coordinates. */
  addWide(kind, ends, material) {
    if (ends.length === 0) return;
    this.lines[kind] = new LineSegments2(new LineSegmentsGeometry().setPositions(ends), material);
    this.group.add(this.lines[kind]);
  }

  /** Draw lines of a kind as thin as can be. */
  addThin(kind, ends, material) {
    const buffer = new BufferGeometry();
    buffer.setAttribute("position", new BufferAttribute(ends, 3));
    this.lines[kind] = new LineSegments(buffer, material);
    this.group.add(this.lines[kind]);
  }

  /** Stand at an offset, as itself or as a ghost, or not at all, with lines of some kinds. */
  update({ offset, solid, hidden, shown }) {
    this.group.visible = !hidden;
    this.surface.material = solid ? this.solid : this.ghost;
    this.surface.renderOrder = solid ? 0 : 1;
    for (const [kind, lines] of Object.entries(this.lines)) lines.visible = solid && shown[kind];
    this.group.position.copy(offset);
    this.group.updateMatrixWorld();
    this.twin.visible = solid;
    this.twin.matrix.copy(this.group.matrixWorld);
    this.twin.matrixWorldNeedsUpdate = true;
  }

  highlight(on) {
    const glow = on ? 0.28 : 0;
    if (this.solid.uniforms) this.solid.uniforms.glow.value = glow;
    else this.solid.emissive.copy(this.solid.color).multiplyScalar(glow);
  }

  dispose() {
    this.group.traverse((each) => each.geometry?.dispose());
    for (const material of [this.solid, this.ghost, this.twin.material]) material.dispose();
    this.group.removeFromParent();
    this.twin.removeFromParent();
  }
}

/** (9 n) normals of the corners of some triangles. */
function cornersOf(normals, members) {
  const found = new Float32Array(9 * members.length);
  members.forEach((t, i) => found.set(normals.subarray(9 * t, 9 * t + 9), 9 * i));
  return found;
}

/** (3 n) coordinates of the vertices of some triangles, or of some vertices. */
export function gather(positions, members, triangles) {
  const corners = triangles ? 3 : 1;
  const found = new Float32Array(3 * corners * members.length);
  for (let i = 0; i < members.length; i++) {
    for (let j = 0; j < corners; j++) {
      const from = 3 * (triangles ? triangles[3 * members[i] + j] : members[i]);
      const to = 3 * (corners * i + j);
      found[to] = positions[from];
      found[to + 1] = positions[from + 1];
      found[to + 2] = positions[from + 2];
    }
  }
  return found;
}

/** Where the middle of a part is, by area, and how much there is of it. */
function middleOf(coordinates, areTriangles) {
  const middle = new Vector3();
  let mass = 0;
  const [a, b, c] = [new Vector3(), new Vector3(), new Vector3()];
  const step = areTriangles ? 9 : 3;
  for (let i = 0; i < coordinates.length; i += step) {
    a.fromArray(coordinates, i);
    let share = 1;
    if (areTriangles) {
      b.fromArray(coordinates, i + 3);
      c.fromArray(coordinates, i + 6);
      const sum = a.clone().add(b).add(c).divideScalar(3);
      share = b.sub(a).cross(c.sub(a)).length() / 2;
      a.copy(sum);
    }
    middle.addScaledVector(a, share);
    mass += share;
  }
  return { middle: mass > 0 ? middle.divideScalar(mass) : middle, mass };
}
