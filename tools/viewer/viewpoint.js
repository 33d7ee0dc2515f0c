// From where the scene is seen: the camera, what moves it, and the lamps that it carries.

import { DirectionalLight, PerspectiveCamera, Spherical, Vector3 } from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";

const FIELD_OF_VIEW = 28; // degrees; narrow, so that parts far away look as large as they are
const [YAW, PITCH] = [Math.PI / 6, Math.PI / 9]; // of the first view, which shows three sides of a box
const MARGIN = 1.12;
const TOOLS = 68; // pixels at the lower end of the canvas that the tools take
/** Half of what is seen at a distance of 1, upward. */
const RISE = Math.tan((FIELD_OF_VIEW * Math.PI) / 360);

export class Viewpoint {
  /**
   * @param canvas what is dragged
   * @param stands the unit directions `right`, `up` and `front` of the shape as it stands
   * @param changed called when the view has changed
   */
  constructor(canvas, stands, changed) {
    this.first = threeQuarter(stands);
    this.camera = new PerspectiveCamera(FIELD_OF_VIEW, 1, 0.01, 50);
    this.camera.up.copy(this.first.vertical);
    // The key comes from over the viewer's left shoulder, wherever the viewer goes.
    for (const [place, strength] of [
      [[-0.5, 0.55, 0.67], 1.75],
      [[0.9, -0.1, 0.3], 0.35],
    ]) {
      const lamp = new DirectionalLight(0xffffff, strength);
      lamp.position.set(...place);
      this.camera.add(lamp, lamp.target);
    }
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableDamping = true;
    this.controls.dampingFactor = 0.12;
    this.controls.minDistance = 0.05;
    this.controls.maxDistance = 20;
    this.controls.zoomToCursor = true;
    this.controls.addEventListener("change", changed);
  }

  /** Fit a canvas; returns how many pixels a unit at a distance of 1 is high. */
  resize(width, height) {
    this.size = [width, height];
    this.camera.aspect = width / height;
    // What is in the middle is seen in the middle of the room over the tools.
    this.camera.setViewOffset(width, height, 0, TOOLS / 2, width, height);
    this.camera.updateProjectionMatrix();
    return height / (2 * RISE);
  }

  /**
   * Look as at first: what lies at the positions fills the canvas.
   *
   * @param positions (3 n) coordinates
   * @param back how much further away than that takes
   */
  reset(positions, back) {
    const { right, up, toward } = this.first;
    const [width, height] = this.size;
    const run = (RISE * width) / height;
    const rise = RISE * Math.max(0.5, 1 - TOOLS / height); // of the room over the tools
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
    distance *= back;
    this.controls.target.copy(target);
    this.camera.position.copy(target).addScaledVector(toward, distance);
    this.controls.update();
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
  }

  /** Come nearer, or go away where the factor is over 1. */
  zoom(factor) {
    const { camera, controls } = this;
    camera.position.sub(controls.target).multiplyScalar(factor).add(controls.target);
    controls.update();
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
