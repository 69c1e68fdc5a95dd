// SPDX-License-Identifier: Apache-2.0

/** A JPEG that the browser renders: the texture alone, or the surface where the camera sees it, on
    a ground whose colour distinguishes even and odd frames. */
export async function draw_picture(page, given) {
  const address = await page.evaluate(({ mesh, camera, number, vertices_m }) => {
    const canvas = document.createElement("canvas");
    canvas.width = camera.width_px;
    canvas.height = camera.height_px;
    const pen = canvas.getContext("2d");
    pen.fillStyle = number === 1 ? "#3c3f33" : "#33373f";
    pen.fillRect(0, 0, canvas.width, canvas.height);
    const at = (v) => {
      const [left, top] = mesh.uv.slice(2 * v, 2 * v + 2);
      if (number === null) return [left * canvas.width, top * canvas.height];
      const [x, y, z] = vertices_m.slice(3 * v, 3 * v + 3);
      return [(camera.fx * x) / z + camera.cx, (camera.fy * y) / z + camera.cy];
    };
    for (let f = 0; f < mesh.faces.length; f += 3) {
      const hue = (f * 53) % 360;
      pen.fillStyle = pen.strokeStyle = `hsl(${hue} 35% ${45 + ((f / 3) % 4) * 10}%)`;
      pen.beginPath();
      for (const v of mesh.faces.slice(f, f + 3)) pen.lineTo(...at(v));
      pen.closePath();
      pen.fill();
      pen.stroke();
    }
    return canvas.toDataURL("image/jpeg", 0.9);
  }, given);
  return { address, bytes: Buffer.from(address.split(",")[1], "base64") };
}
