// How points of a cloud are drawn: small discs that are shaded as if they were balls.

import { Color, ShaderMaterial } from "three";

const VERTEX = `
uniform float size;
uniform float pixels;
void main() {
  vec4 place = modelViewMatrix * vec4(position, 1.0);
  gl_Position = projectionMatrix * place;
  gl_PointSize = max(2.0, size * pixels / -place.z);
}`;

const FRAGMENT = `
uniform vec3 color;
uniform float glow;
uniform float plain;
uniform float opacity;
void main() {
  vec2 across = 2.0 * gl_PointCoord - 1.0;
  float r = dot(across, across);
  if (r > 1.0) discard;
  vec3 normal = vec3(across.x, -across.y, sqrt(1.0 - r));
  float light = 0.42 + 0.14 * normal.y + 0.5 * max(dot(normal, vec3(-0.47, 0.52, 0.71)), 0.0);
  gl_FragColor = vec4(mix(color * (light + glow), color, plain), opacity);
  if (plain < 0.5) {
    #include <colorspace_fragment>
  }
}`;

/**
 * A material for points as wide as the surface that they stand for.
 *
 * `size` in scene units; `pixels` a uniform that several materials share, how many pixels a unit
 * has at a distance of 1; `plain` for the colour as it is, without light, to pick by.
 */
export function pointMaterial({ color, size, pixels, plain = false, opacity = 1 }) {
  return new ShaderMaterial({
    vertexShader: VERTEX,
    fragmentShader: FRAGMENT,
    transparent: opacity < 1,
    depthWrite: opacity === 1,
    uniforms: {
      color: { value: new Color(color) },
      glow: { value: 0 },
      plain: { value: plain ? 1 : 0 },
      opacity: { value: opacity },
      size: { value: size },
      pixels,
    },
  });
}
