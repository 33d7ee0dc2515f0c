// How points of a cloud are drawn: discs that are lit as the surface is on which they lie.

import { Color, ShaderMaterial } from "three";

const VERTEX = `
uniform float size;
uniform float pixels;
varying vec3 across;
void main() {
  vec4 place = modelViewMatrix * vec4(position, 1.0);
  gl_Position = projectionMatrix * place;
  gl_PointSize = max(2.0, size * pixels / -place.z);
  across = normalMatrix * normal;
  if (dot(across, place.xyz) > 0.0) across = -across; // either side of a surface is lit
}`;

const FRAGMENT = `
uniform vec3 color;
uniform float glow;
uniform float plain;
uniform float opacity;
varying vec3 across;
void main() {
  vec2 aside = 2.0 * gl_PointCoord - 1.0;
  if (dot(aside, aside) > 1.0) discard;
  vec3 normal = normalize(across);
  float light = 0.36 + 0.16 * normal.y + 0.62 * max(dot(normal, vec3(-0.5, 0.55, 0.67)), 0.0);
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
