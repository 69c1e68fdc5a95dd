// SPDX-License-Identifier: Apache-2.0
// The page on which the corners of a sheet in its photograph are moved. The build puts
// framework/web/src/corners.js in place of the import.
import { first_corners, fault_of, kNames, make_ring, to_share, within } from "corners.js";

/** As the command takes them. */
export const corners_text = (corners) => corners.map(([x, y]) => `${x},${y}`).join(" ");
export const option_text = (corners) => `--corners "${corners_text(corners)}"`;
/** As the plugin takes them. */
export const parameter_text = (corners) => `corners: [${corners.flat().join(", ")}]`;

const kZoom = 6; // of the loupe, against the photograph as it is shown
const kFewest_px = 16; // of the photograph, across the loupe

/** The rings over the photograph, and the words beside it. */
class CornerPage {
  #one = (selector) => document.querySelector(selector);
  #looked_at = null; // index of the corner in the loupe

  constructor(photograph) {
    this.sizes_px = [photograph.width_px, photograph.height_px];
    this.corners = first_corners(photograph);
    this.photo = this.#one("#photo");
    this.image = this.#one("#image");
    this.loupe = this.#one("#loupe");
    const [width_px, height_px] = this.sizes_px;
    this.photo.style.setProperty("--aspect", width_px / height_px);
    this.#one("#sides").setAttribute("viewBox", `-0.5 -0.5 ${width_px} ${height_px}`);
    this.#one("#found").textContent = photograph.corners_px
      ? "The rings stand where the corners were found, or given."
      : "No object was found in this photograph, or not where it was said to be.";
    this.rings = kNames.map((name, k) => this.#make_ring(name, k));
    this.inputs = kNames.map((name, k) => this.#make_inputs(name, k));
    for (const button of document.querySelectorAll("[data-copies]")) {
      button.addEventListener("click", () => this.#copy(this.#one(`#${button.dataset.copies}`)));
    }
    addEventListener("resize", () => this.#draw_loupe());
  }

  async show(picture) {
    this.image.src = picture;
    await this.image.decode();
    this.#draw();
  }

  #make_ring(name, k) {
    const ring = make_ring(name, {
      box: () => this.image.getBoundingClientRect(),
      sizes_px: () => this.sizes_px,
      place: () => this.corners[k],
      move: (place_px, is_by_key) => {
        this.#move(k, place_px);
        if (is_by_key) this.#one("#announcement").textContent = this.corners[k].join(", ");
      },
    });
    ring.dataset.row = k < 2 ? "top" : "bottom";
    ring.append(Object.assign(document.createElement("span"), { textContent: k + 1 }));
    this.#look_while_focused(ring, k);
    this.photo.append(ring);
    return ring;
  }

  #make_inputs(name, k) {
    const row = document.createElement("tr");
    const head = Object.assign(document.createElement("th"), { scope: "row" });
    head.textContent = `${k + 1} ${name}`;
    row.append(head);
    const inputs = ["x", "y"].map((letter, axis) => {
      const input = Object.assign(document.createElement("input"), { type: "number", step: 0.1 });
      input.setAttribute("aria-label", `${name} ${letter}, px`);
      input.addEventListener("input", () => {
        const typed_px = input.valueAsNumber;
        if (!Number.isFinite(typed_px)) return;
        this.#move(k, this.corners[k].map((px, other) => (other === axis ? typed_px : px)));
      });
      input.addEventListener("change", () => this.#draw());
      this.#look_while_focused(input, k);
      const cell = document.createElement("td");
      cell.append(input);
      row.append(cell);
      return input;
    });
    this.#one("#places").append(row);
    return inputs;
  }

  #look_while_focused(element, k) {
    element.addEventListener("focus", () => this.#look_at(k));
    element.addEventListener("blur", () => this.#look_at(null));
  }

  #look_at(k) {
    this.#looked_at = k;
    this.#draw_loupe();
  }

  #move(k, place_px) {
    this.corners[k] = within(place_px, this.sizes_px);
    this.#draw();
  }

  #draw() {
    this.corners.forEach((place, k) => {
      const ring = this.rings[k];
      const [x, y] = place.map((px, axis) => 100 * to_share(px, this.sizes_px[axis]));
      ring.style.left = `${x}%`;
      ring.style.top = `${y}%`;
      ring.setAttribute("aria-label", `${kNames[k]} corner: ${place.join(", ")} px`);
      this.inputs[k].forEach((input, axis) => {
        if (Number(input.value) !== place[axis] || input.value === "") input.value = place[axis];
      });
    });
    for (const polygon of document.querySelectorAll("#sides polygon")) {
      polygon.setAttribute("points", corners_text(this.corners));
    }
    const [fault, notice] = [fault_of(this.corners), this.#one("#fault")];
    if (notice.textContent !== fault) notice.textContent = fault;
    notice.hidden = fault === "";
    this.#one("#option").value = option_text(this.corners);
    this.#one("#parameter").value = parameter_text(this.corners);
    this.#one("#outcome").textContent = "";
    this.#draw_loupe();
  }

  /** The surroundings of a corner, enlarged, with the sides that meet there, in the part of the
      photograph opposite to it. */
  #draw_loupe() {
    const k = this.#looked_at;
    this.loupe.hidden = k === null;
    if (k === null) return;
    const [x, y] = this.corners[k];
    const [width_px] = this.sizes_px;
    this.loupe.dataset.column = to_share(x, width_px) > 0.5 ? "left" : "right";
    this.loupe.dataset.row = to_share(y, this.sizes_px[1]) > 0.5 ? "top" : "bottom";
    const shown = this.image.clientWidth / width_px; // px of the screen in one of the photograph
    const across_px = Math.max(kFewest_px, this.loupe.clientWidth / (kZoom * shown));
    const size = this.loupe.width;
    const stored = this.image.naturalWidth / width_px; // the page's picture may be smaller
    const pen = this.loupe.getContext("2d");
    pen.imageSmoothingEnabled = false;
    pen.fillStyle = "#000";
    pen.fillRect(0, 0, size, size);
    pen.drawImage(
      this.image,
      stored * (x + 0.5 - across_px / 2),
      stored * (y + 0.5 - across_px / 2),
      stored * across_px,
      stored * across_px,
      0,
      0,
      size,
      size,
    );
    const lines = new Path2D();
    for (const other of [this.corners[(k + 1) % 4], this.corners[(k + 3) % 4]]) {
      lines.moveTo(size / 2, size / 2);
      lines.lineTo(
        size / 2 + ((other[0] - x) * size) / across_px,
        size / 2 + ((other[1] - y) * size) / across_px,
      );
    }
    const style = getComputedStyle(document.documentElement);
    for (const [colour, width] of [
      ["rgb(0 0 0 / 60%)", 5],
      [style.getPropertyValue("--side"), 2],
    ]) {
      pen.strokeStyle = colour;
      pen.lineWidth = width;
      pen.stroke(lines);
    }
  }

  async #copy(field) {
    field.select();
    let outcome = "Copied.";
    try {
      await navigator.clipboard.writeText(field.value);
    } catch {
      outcome = "Selected: copy it with Ctrl+C or Command+C.";
    }
    this.#one("#outcome").textContent = outcome;
  }
}

if (typeof document !== "undefined") {
  const photograph = JSON.parse(document.querySelector("#photograph").textContent);
  await new CornerPage(photograph).show(photograph.picture);
  document.documentElement.dataset.ready = "true";
}
