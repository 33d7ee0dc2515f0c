// The scene: parts that can be turned, hidden, pulled apart and picked. Knows three.js, no page.
//
// Each part is a group of its own, with its piece of the surface, its boundaries and its wires, so
// that to hide or to move it takes no new geometry. Frames are drawn when something changes, not
// all the time. Which part is under the pointer is read from a picture of the parts' numbers, which
// is drawn once for each view that is asked about: as quick for a million triangles as for ten.

import {
  AmbientLight,
  Group,
  HemisphereLight,
  LineBasicMaterial,
  Mesh,
  MeshBasicMaterial,
  Raycaster,
  Scene,
  SphereGeometry,
  Vector2,
  Vector3,
  WebGLRenderer,
  WebGLRenderTarget,
} from "three";
import { LineMaterial } from "three/addons/lines/LineMaterial.js";

import { gather, Part } from "./part.js";
import { cornerNormals, findEdges } from "./surface.js";
import { Viewpoint } from "./viewpoint.js";

const FARTHEST_APART = 1.1; // of an exploded part, in distances of its middle from the whole's
const BACK = 0.55; // how much further away an exploded shape is seen from
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
    this.viewpoint = new Viewpoint(canvas, view, () => this.draw());
    this.camera = this.viewpoint.camera;
    this.controls = this.viewpoint.controls;
    const sky = new HemisphereLight(0xffffff, 0x8a8f99, 0.95);
    sky.position.set(...view.up);
    this.scene.add(new AmbientLight(0xffffff, 0.55), sky, this.camera);
    const { positions, triangles, normals } = geometry;
    this.normals = triangles ? cornerNormals(positions, triangles) : normals;
    this.boundaryMaterial = new LineMaterial({ linewidth: LINE_WIDTH });
    this.wireMaterial = new LineBasicMaterial({ transparent: true, opacity: 0.28 });
    this.markers = new Group();
    this.scene.add(this.markers);
    this.parts = [];
    this.setLabels(geometry.labels);
  }

  // -- parts ------------------------------------------------------------------------------------

  /** Divide the surface anew: a label for each triangle, or for each point. */
  setLabels(labels) {
    for (const part of this.parts) part.dispose();
    this.labels = labels;
    this.edges = null;
    const members = this.colors.map(() => []);
    labels.forEach((label, i) => members[label].push(i));
    const { geometry, normals, pixels, cssPixels } = this;
    this.parts = members.map((list, k) => {
      const color = this.colors[k];
      const part = { members: Uint32Array.from(list), geometry, normals, color, pixels, cssPixels };
      return new Part(k, part);
    });
    const whole = new Vector3();
    let mass = 0;
    for (const part of this.parts) {
      this.scene.add(part.group);
      this.numbers.add(part.twin);
      whole.addScaledVector(part.middle, part.mass);
      mass += part.mass;
    }
    this.middle = whole.divideScalar(mass || 1);
    this.#drawBoundaries();
    this.refresh();
  }

  #edgesOf(k, kind) {
    const { positions, triangles, elements } = this.geometry;
    this.edges ??= findEdges(positions, triangles, this.labels, elements, this.parts.length);
    return gather(positions, this.edges[kind][k], null);
  }

  #drawBoundaries() {
    if (!this.geometry.triangles) return;
    for (const part of this.parts) {
      part.addWide("boundaries", this.#edgesOf(part.k, "boundaries"), this.boundaryMaterial);
    }
  }

  #drawWires() {
    if (!this.geometry.triangles) return;
    for (const part of this.parts) {
      if (!part.lines.wires) part.addThin("wires", this.#edgesOf(part.k, "wires"), this.wireMaterial);
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
      part.update({
        offset: this.offset(part.k),
        solid: this.isSolid(part.k),
        hidden: this.hidden.has(part.k),
        shown: this.shown,
      });
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
    this.viewpoint.zoom((1 + BACK * amount) / (1 + BACK * this.explosion));
    this.explosion = amount;
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
    for (const part of this.parts) part.highlight(part.k === k);
    this.paint();
  }

  /** Look as at first: the whole shape fills the canvas. */
  resetView() {
    this.viewpoint.reset(this.geometry.positions, 1 + BACK * this.explosion);
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

  resize(width, height) {
    this.size = [width, height];
    this.renderer.setPixelRatio(Math.min(2, window.devicePixelRatio));
    this.renderer.setSize(width, height, false);
    this.cssPixels.value = this.viewpoint.resize(width, height);
    this.pixels.value = this.cssPixels.value * this.renderer.getPixelRatio();
    this.target?.dispose();
    this.target = new WebGLRenderTarget(width, height);
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
      material.color.set(dark ? 0x05070a : 0x10151c);
    }
    this.paint();
  }
}
