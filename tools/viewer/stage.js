// The scene: parts that can be turned, hidden, pulled apart and picked. Knows three.js, no page.
//
// Each part is a group of its own, with its piece of the surface, its boundaries and its wires, so
// that to hide or to move it takes no new geometry. Frames are drawn when something changes, not
// all the time. Which part is under the pointer is read from a picture of the parts' numbers, which
// is drawn once for each view that is asked about: as quick for a million triangles as for ten.

import {
  AmbientLight,
  BufferAttribute,
  BufferGeometry,
  Color,
  DirectionalLight,
  DoubleSide,
  Group,
  HemisphereLight,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  MeshBasicMaterial,
  MeshPhongMaterial,
  PerspectiveCamera,
  Points,
  Raycaster,
  Scene,
  SphereGeometry,
  Spherical,
  Vector2,
  Vector3,
  WebGLRenderer,
  WebGLRenderTarget,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { LineMaterial } from "three/addons/lines/LineMaterial.js";
import { LineSegments2 } from "three/addons/lines/LineSegments2.js";
import { LineSegmentsGeometry } from "three/addons/lines/LineSegmentsGeometry.js";

import { pointMaterial } from "./points.js";
import { cornerNormals, findEdges } from "./surface.js";

const FIELD_OF_VIEW = 28; // degrees; narrow, so that parts far away look as large as they are
const FARTHEST_APART = 1.1; // of an exploded part, in distances of its middle from the whole's
const MARGIN = 1.12;
const TOOLS = 68; // pixels at the lower end of the canvas that the tools take
const [YAW, PITCH] = [Math.PI / 6, Math.PI / 9]; // of the first view; as in moseg_core/view/camera.py
const LINE_WIDTH = 2.25; // of boundaries, pixels

export class Stage {
  /**
   * @param canvas where to draw
   * @param geometry from unpackGeometry
   * @param view the unit directions `right`, `up` and `front` of the shape as it stands
   * @param colors of the parts, as "#rrggbb"
   */
  constructor(canvas, { geometry, view, colors }) {
    this.geometry = geometry;
    this.colors = colors;
    this.view = threeQuarter(view);
    this.explosion = 0;
    this.shown = { boundaries: true, wires: false };
    this.isolated = null;
    this.hidden = new Set();
    this.frames = 0;
    this.pixels = { value: 1 };
    this.cssPixels = { value: 1 };
    this.onFrame = () => {};
    this.renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true });
    this.scene = new Scene();
    this.numbers = new Scene(); // the same parts, each in the colour of its number
    this.camera = new PerspectiveCamera(FIELD_OF_VIEW, 1, 0.01, 50);
    this.camera.up.copy(this.view.vertical);
    this.#light();
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableDamping = true;
    this.controls.dampingFactor = 0.12;
    this.controls.minDistance = 0.05;
    this.controls.maxDistance = 20;
    this.controls.zoomToCursor = true;
    this.controls.addEventListener("change", () => this.draw());
    this.normals = geometry.triangles
      ? cornerNormals(geometry.positions, geometry.triangles)
      : null;
    this.markers = new Group();
    this.scene.add(this.markers);
    this.parts = [];
    this.setLabels(geometry.labels);
  }

  #light() {
    this.scene.add(new AmbientLight(0xffffff, 0.55));
    const sky = new HemisphereLight(0xffffff, 0x8a8f99, 0.95);
    sky.position.copy(this.view.vertical);
    this.scene.add(sky);
    // The key comes from over the viewer's left shoulder, wherever the viewer goes.
    for (const [place, strength] of [
      [[-0.5, 0.55, 0.67], 1.75],
      [[0.9, -0.1, 0.3], 0.35],
    ]) {
      const lamp = new DirectionalLight(0xffffff, strength);
      lamp.position.set(...place);
      this.camera.add(lamp, lamp.target);
    }
    this.scene.add(this.camera);
  }

  // -- parts ------------------------------------------------------------------------------------

  /** Divide the surface anew: a label for each triangle, or for each point. */
  setLabels(labels) {
    for (const part of this.parts) part.dispose();
    this.labels = labels;
    this.edges = null;
    const members = this.colors.map(() => []);
    labels.forEach((label, i) => members[label].push(i));
    this.parts = members.map((list, k) => this.#part(k, Uint32Array.from(list)));
    const whole = new Vector3();
    let mass = 0;
    for (const part of this.parts) {
      whole.addScaledVector(part.middle, part.mass);
      mass += part.mass;
    }
    this.middle = whole.divideScalar(mass || 1);
    this.#drawBoundaries();
    this.refresh();
  }

  #part(k, members) {
    const group = new Group();
    const buffer = new BufferGeometry();
    const { positions, triangles, pointSize: size } = this.geometry;
    const { pixels, cssPixels } = this;
    const color = this.colors[k];
    const number = new Color().setRGB(((k + 1) >> 8) / 255, ((k + 1) & 255) / 255, 0);
    let surface, twin, ghost;
    if (triangles) {
      buffer.setAttribute("position", new BufferAttribute(gather(positions, members, triangles), 3));
      const normals = new Float32Array(9 * members.length);
      members.forEach((t, i) => normals.set(this.normals.subarray(9 * t, 9 * t + 9), 9 * i));
      buffer.setAttribute("normal", new BufferAttribute(normals, 3));
      // Surfaces lie a little behind the lines that are drawn on them.
      const behind = { polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 };
      const material = new MeshPhongMaterial({
        ...behind, color, side: DoubleSide, specular: 0x161616, shininess: 28,
      });
      surface = new Mesh(buffer, material);
      twin = new Mesh(buffer, new MeshBasicMaterial({ color: number, side: DoubleSide }));
      ghost = new MeshPhongMaterial({
        ...behind, color: 0x8b95a5, side: DoubleSide, transparent: true, opacity: 0.1,
        depthWrite: false,
      });
    } else {
      const normals = gather(this.geometry.normals, members, null);
      buffer.setAttribute("position", new BufferAttribute(gather(positions, members, null), 3));
      buffer.setAttribute("normal", new BufferAttribute(normals, 3));
      surface = new Points(buffer, pointMaterial({ color, size, pixels }));
      twin = new Points(buffer, pointMaterial({ color: number, size, pixels: cssPixels, plain: true }));
      ghost = pointMaterial({ color: 0x8b95a5, size, pixels, opacity: 0.07 });
    }
    const solid = surface.material;
    twin.matrixAutoUpdate = false;
    group.add(surface);
    this.scene.add(group);
    this.numbers.add(twin);
    const { middle, mass } = middleOf(buffer.attributes.position.array, triangles !== null);
    const part = { k, group, surface, twin, solid, ghost, members, middle, mass, lines: {} };
    part.dispose = () => {
      group.traverse((each) => each.geometry?.dispose());
      for (const material of [solid, ghost, twin.material]) material.dispose();
      group.removeFromParent();
      twin.removeFromParent();
    };
    return part;
  }

  #edgesOf(k) {
    const { positions, triangles, elements } = this.geometry;
    this.edges ??= findEdges(positions, triangles, this.labels, elements, this.parts.length);
    return {
      boundaries: gather(positions, this.edges.boundaries[k], null),
      wires: gather(positions, this.edges.wires[k], null),
    };
  }

  #drawBoundaries() {
    if (!this.geometry.triangles) return;
    this.boundaryMaterial ??= new LineMaterial({ color: 0x10151c, linewidth: LINE_WIDTH });
    for (const part of this.parts) {
      const ends = this.#edgesOf(part.k).boundaries;
      if (ends.length === 0) continue;
      part.lines.boundaries = new LineSegments2(
        new LineSegmentsGeometry().setPositions(ends),
        this.boundaryMaterial,
      );
      part.group.add(part.lines.boundaries);
    }
  }

  #drawWires() {
    if (!this.geometry.triangles) return;
    this.wireMaterial ??= new LineBasicMaterial({
      color: 0x10151c, transparent: true, opacity: 0.28,
    });
    for (const part of this.parts) {
      if (part.lines.wires) continue;
      const buffer = new BufferGeometry();
      buffer.setAttribute("position", new BufferAttribute(this.#edgesOf(part.k).wires, 3));
      part.lines.wires = new LineSegments(buffer, this.wireMaterial);
      part.group.add(part.lines.wires);
    }
  }

  // -- what is seen -----------------------------------------------------------------------------

  /** Whether a part can be seen, hovered and clicked; others are ghosts, or hidden. */
  isSolid(k) {
    return !this.hidden.has(k) && (this.isolated === null || this.isolated === k);
  }

  /** Bring the scene up to what is hidden, isolated, exploded and drawn. */
  refresh() {
    if (this.shown.wires) this.#drawWires();
    for (const part of this.parts) {
      const solid = this.isSolid(part.k);
      part.group.visible = !this.hidden.has(part.k);
      part.surface.material = solid ? part.solid : part.ghost;
      part.surface.renderOrder = solid ? 0 : 1;
      for (const [kind, lines] of Object.entries(part.lines)) {
        lines.visible = solid && this.shown[kind];
      }
      part.group.position.copy(this.offset(part.k));
      part.group.updateMatrixWorld();
      part.twin.visible = solid;
      part.twin.matrix.copy(part.group.matrixWorld);
      part.twin.matrixWorldNeedsUpdate = true;
    }
    for (const marker of this.markers.children) {
      marker.position.copy(marker.userData.place).add(this.offset(marker.userData.part));
    }
    this.draw();
  }

  /** How far an exploded part is from its place. */
  offset(k) {
    const part = this.parts[k];
    if (part.mass === 0) return new Vector3();
    return part.middle.clone().sub(this.middle).multiplyScalar(FARTHEST_APART * this.explosion);
  }

  /** Pull the parts apart, 0 not at all to 1; the viewer steps back to see them. */
  explode(amount) {
    const step = (1 + 0.55 * amount) / (1 + 0.55 * this.explosion);
    this.explosion = amount;
    this.camera.position.sub(this.controls.target).multiplyScalar(step).add(this.controls.target);
    this.refresh();
  }

  isolate(k) {
    this.isolated = k;
    this.refresh();
  }

  hide(k, hidden) {
    if (hidden) this.hidden.add(k);
    else this.hidden.delete(k);
    this.refresh();
  }

  show(kind, on) {
    this.shown[kind] = on;
    this.refresh();
  }

  highlight(k) {
    for (const part of this.parts) {
      const glow = part.k === k ? 0.28 : 0;
      if (part.solid.uniforms) part.solid.uniforms.glow.value = glow;
      else part.solid.emissive.copy(part.solid.color).multiplyScalar(glow);
    }
    this.paint();
  }

  // -- the viewer -------------------------------------------------------------------------------

  /** Look as at first: the whole shape fills the canvas. */
  resetView() {
    const { right, up, toward } = this.view;
    const [width, height] = this.size;
    const whole = Math.tan((FIELD_OF_VIEW * Math.PI) / 360);
    const run = (whole * width) / height;
    const rise = whole * Math.max(0.5, 1 - TOOLS / height);
    const { positions } = this.geometry;
    const low = [Infinity, Infinity];
    const high = [-Infinity, -Infinity];
    const place = new Vector3();
    const stride = 3 * Math.max(1, Math.floor(positions.length / 600000));
    for (let i = 0; i < positions.length; i += stride) {
      place.fromArray(positions, i);
      [right, up].forEach((axis, j) => {
        low[j] = Math.min(low[j], place.dot(axis));
        high[j] = Math.max(high[j], place.dot(axis));
      });
    }
    const target = right.clone().multiplyScalar((low[0] + high[0]) / 2);
    target.addScaledVector(up, (low[1] + high[1]) / 2);
    let distance = 0.1;
    for (let i = 0; i < positions.length; i += stride) {
      place.fromArray(positions, i).sub(target);
      const across = Math.max(Math.abs(place.dot(right)) / run, Math.abs(place.dot(up)) / rise);
      distance = Math.max(distance, MARGIN * across + place.dot(toward));
    }
    distance *= 1 + 0.55 * this.explosion;
    this.controls.target.copy(target);
    this.camera.position.copy(target).addScaledVector(toward, distance);
    this.controls.update();
    this.draw();
  }

  /** Turn about the target, by angles in radians. */
  turn(across, upward) {
    const { camera, controls } = this;
    // OrbitControls' own spherical coordinates are about camera.up; so are these.
    const toY = new Vector3(0, 1, 0);
    const offset = camera.position.clone().sub(controls.target);
    const level = camera.up.clone();
    const quaternion = camera.quaternion.clone().setFromUnitVectors(level, toY);
    const sphere = new Spherical().setFromVector3(offset.applyQuaternion(quaternion));
    sphere.theta += across;
    sphere.phi = Math.min(Math.PI - 0.01, Math.max(0.01, sphere.phi + upward));
    offset.setFromSpherical(sphere).applyQuaternion(quaternion.invert());
    camera.position.copy(controls.target).add(offset);
    controls.update();
    this.draw();
  }

  /** Where the camera is and what it looks at, as plain numbers for `lookFrom`. */
  lookingFrom() {
    return { from: this.camera.position.toArray(), at: this.controls.target.toArray() };
  }

  lookFrom({ from, at }) {
    this.camera.position.fromArray(from);
    this.controls.target.fromArray(at);
    this.controls.update();
    this.draw();
  }

  /** Come nearer, or go away where the factor is over 1. */
  zoom(factor) {
    const { camera, controls } = this;
    camera.position.sub(controls.target).multiplyScalar(factor).add(controls.target);
    controls.update();
    this.draw();
  }

  resize(width, height) {
    this.size = [width, height];
    this.renderer.setPixelRatio(Math.min(2, window.devicePixelRatio));
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    // What is in the middle is seen in the middle of the room over the tools.
    this.camera.setViewOffset(width, height, 0, TOOLS / 2, width, height);
    this.camera.updateProjectionMatrix();
    this.target?.dispose();
    this.target = new WebGLRenderTarget(width, height);
    const rise = 2 * Math.tan((FIELD_OF_VIEW * Math.PI) / 360);
    this.pixels.value = (height * this.renderer.getPixelRatio()) / rise;
    this.cssPixels.value = height / rise;
    this.draw();
  }

  /** Ask for a frame in which places have changed. */
  draw() {
    this.stale = true; // the picture of the parts' numbers
    this.paint();
  }

  /** Ask for a frame; several requests before it is due are one. */
  paint() {
    if (this.asked) return;
    this.asked = requestAnimationFrame(() => {
      this.asked = null;
      if (!this.size) return;
      this.controls.update(); // asks for the next frame itself while the view glides
      this.renderer.render(this.scene, this.camera);
      this.frames += 1;
      this.onFrame();
    });
  }

  // -- what is under the pointer ----------------------------------------------------------------

  /** The part at a place on the canvas, in CSS pixels from its top left; null for none. */
  partAt(x, y) {
    if (!this.size) return null;
    if (this.stale) {
      this.renderer.setRenderTarget(this.target);
      this.renderer.clear();
      this.renderer.render(this.numbers, this.camera);
      this.renderer.setRenderTarget(null);
      this.stale = false;
    }
    const pixel = new Uint8Array(4);
    const row = this.size[1] - 1 - Math.floor(y);
    this.renderer.readRenderTargetPixels(this.target, Math.floor(x), row, 1, 1, pixel);
    const number = pixel[3] === 0 ? 0 : 256 * pixel[0] + pixel[1];
    return number === 0 ? null : number - 1;
  }

  /** The place on the surface at a place on the canvas: part, element, and where, in model units. */
  placeAt(x, y) {
    const [width, height] = this.size;
    const ray = new Raycaster();
    ray.params.Points.threshold = 0.5 * this.geometry.pointSize;
    ray.setFromCamera(new Vector2((2 * x) / width - 1, 1 - (2 * y) / height), this.camera);
    const solid = this.parts.filter((part) => this.isSolid(part.k));
    const [hit] = ray.intersectObjects(solid.map((part) => part.surface), false);
    if (!hit) return null;
    const part = solid.find((each) => each.surface === hit.object);
    const member = part.members[this.geometry.triangles ? hit.faceIndex : hit.index];
    const place = this.geometry.triangles
      ? hit.point.clone()
      : new Vector3().fromBufferAttribute(hit.object.geometry.attributes.position, hit.index)
          .add(part.group.position);
    place.sub(part.group.position);
    const { elements, toModel } = this.geometry;
    return {
      part: part.k,
      element: elements === null ? member : elements[member],
      at: toModel(place.toArray()),
    };
  }

  /** Show places of parts as balls: a list of `{part, at}` in model units. */
  mark(places) {
    for (const marker of [...this.markers.children]) {
      marker.removeFromParent();
      marker.material.dispose();
    }
    this.ball ??= new SphereGeometry(1, 24, 16);
    for (const { part, at, chosen } of places) {
      const edge = new Mesh(this.ball, new MeshBasicMaterial({ color: 0xffffff, depthTest: false }));
      const ball = new Mesh(
        this.ball,
        new MeshBasicMaterial({ color: this.colors[part], depthTest: false }),
      );
      edge.scale.setScalar(chosen ? 0.015 : 0.0095);
      ball.scale.setScalar(0.72);
      edge.renderOrder = 5;
      ball.renderOrder = 6;
      edge.userData = { part, place: new Vector3(...this.geometry.toScene(at)) };
      edge.add(ball);
      this.markers.add(edge);
    }
    this.refresh();
  }

  /** Lines that are seen on a dark page as well. */
  setDark(dark) {
    for (const material of [this.boundaryMaterial, this.wireMaterial]) {
      material?.color.set(dark ? 0x05070a : 0x10151c);
    }
    this.paint();
  }
}

/** From how a shape stands to a view of three sides of it. */
function threeQuarter(stands) {
  const [right, vertical, front] = ["right", "up", "front"].map((key) => new Vector3(...stands[key]));
  const level = front.clone().multiplyScalar(Math.cos(YAW)).addScaledVector(right, -Math.sin(YAW));
  return {
    vertical,
    right: right.multiplyScalar(Math.cos(YAW)).addScaledVector(front, Math.sin(YAW)),
    up: vertical.clone().multiplyScalar(Math.cos(PITCH)).addScaledVector(level, -Math.sin(PITCH)),
    toward: level.multiplyScalar(Math.cos(PITCH)).addScaledVector(vertical, Math.sin(PITCH)),
  };
}

/** (3 n) coordinates of the vertices of some triangles, or of some vertices. */
function gather(positions, members, triangles) {
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
