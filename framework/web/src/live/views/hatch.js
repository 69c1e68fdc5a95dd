// SPDX-License-Identifier: Apache-2.0
// Hatching of a material where its vertices were not measured, in lines of the screen.

const kPeriod_px = 9;
const kLine_px = 2.5;
const kStrength = 0.75;

/** Makes a material hatch by the attribute `measured`, 0 or 1 of each vertex. */
export function hatch(material, pixel_ratio) {
  const period = (kPeriod_px * pixel_ratio).toFixed(1);
  const line = (kLine_px * pixel_ratio).toFixed(1);
  material.onBeforeCompile = (shader) => {
    shader.vertexShader = shader.vertexShader
      .replace("#include <common>", "#include <common>\nattribute float measured;\nvarying float vMeasured;")
      .replace("#include <begin_vertex>", "#include <begin_vertex>\nvMeasured = measured;");
    shader.fragmentShader = shader.fragmentShader
      .replace("#include <common>", "#include <common>\nvarying float vMeasured;")
      .replace(
        "#include <opaque_fragment>",
        `#include <opaque_fragment>
        if (vMeasured < 0.5 && mod(gl_FragCoord.x + gl_FragCoord.y, ${period}) < ${line}) {
          float grey = dot(gl_FragColor.rgb, vec3(0.3, 0.6, 0.1));
          gl_FragColor.rgb = mix(gl_FragColor.rgb, vec3(grey > 0.25 ? 0.0 : 1.0), ${kStrength});
        }`,
      );
  };
}

/** Which vertices a frame measured: [V] 0 or 1. A shape that was carried over has none. */
export function measured_of({ visible, report }, count) {
  const is_measured = report?.state !== "predicted" && report?.state !== "lost";
  if (!is_measured || visible?.length !== count) return new Float32Array(count).fill(is_measured);
  return Float32Array.from(visible, Boolean);
}
