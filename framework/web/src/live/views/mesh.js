// SPDX-License-Identifier: Apache-2.0
// Geometry of a mesh: edges [2 E], lengths, strain, and where a camera sees its vertices.

const kMostVertices = 2 ** 26;

/** Each edge of the faces [3 F] once, as pairs of vertices. */
export function edges_of(faces) {
  const seen = new Set();
  const edges = [];
  for (let f = 0; f < faces.length; f += 3) {
    for (let k = 0; k < 3; ++k) {
      const a = faces[f + k];
      const b = faces[f + ((k + 1) % 3)];
      const key = Math.min(a, b) * kMostVertices + Math.max(a, b);
      if (seen.has(key)) continue;
      seen.add(key);
      edges.push(a, b);
    }
  }
  return new Uint32Array(edges);
}

/** The length of each edge, m. */
export function edge_lengths(vertices_m, edges) {
  const lengths_m = new Float32Array(edges.length / 2);
  for (let e = 0; e < lengths_m.length; ++e) {
    const a = 3 * edges[2 * e];
    const b = 3 * edges[2 * e + 1];
    const x = vertices_m[a] - vertices_m[b];
    const y = vertices_m[a + 1] - vertices_m[b + 1];
    const z = vertices_m[a + 2] - vertices_m[b + 2];
    lengths_m[e] = Math.sqrt(x * x + y * y + z * z);
  }
  return lengths_m;
}

/** For each vertex the share by which its edges are longer than at rest (shorter: below 0), in the
    mean. */
export function vertex_strain(vertices_m, edges, rest_m) {
  const strain = new Float32Array(vertices_m.length / 3);
  const counts = new Uint32Array(strain.length);
  edge_lengths(vertices_m, edges).forEach((length_m, e) => {
    if (!(rest_m[e] > 0)) return;
    for (let end = 2 * e; end < 2 * e + 2; ++end) {
      strain[edges[end]] += length_m / rest_m[e] - 1;
      ++counts[edges[end]];
    }
  });
  return strain.map((sum, v) => (counts[v] ? sum / counts[v] : 0));
}

/** Pixels [2 V] at which the camera sees the vertices; NaN for those that are not before it. */
export function project(vertices_m, { fx, fy, cx, cy }) {
  const at_px = new Float32Array((vertices_m.length / 3) * 2);
  for (let v = 0; 3 * v < vertices_m.length; ++v) {
    const depth_m = vertices_m[3 * v + 2];
    const before = depth_m > 0;
    at_px[2 * v] = before ? (fx * vertices_m[3 * v]) / depth_m + cx : NaN;
    at_px[2 * v + 1] = before ? (fy * vertices_m[3 * v + 1]) / depth_m + cy : NaN;
  }
  return at_px;
}
