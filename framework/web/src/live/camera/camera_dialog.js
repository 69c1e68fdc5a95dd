// SPDX-License-Identifier: Apache-2.0
// The dialog of the camera: which one, how it takes images, and its calibration.
import { element } from "../../data.js";
import { outcome_words } from "../words.js";
import { Calibration } from "./calibration.js";
import { choice_settings, mode_words, option_words, values_of_source } from "./source.js";

export class CameraDialog {
  #cameras = [];
  #source = null; // of the run, {id, parameters}
  #restarts = false; // the run, by a request of this page

  constructor(dialog, change_requests) {
    this.dialog = dialog;
    this.change_requests = change_requests;
    const part = (name) => dialog.querySelector(name);
    this.device = part("[name=device]");
    this.mode = part("[name=mode]");
    this.exposure = part("[name=exposure]");
    this.exposure_ms = part("[name=exposure_ms]");
    this.rotation = part("[name=rotation]");
    this.assumed = part("[name=assumed]");
    this.command = part("code");
    this.words = part("#camera-words");
    this.start = part("#camera-start");
    this.calibration = new Calibration(part("#calibration"), {
      source: () => this.#source,
      ask: (text, told) => change_requests.now(text, told),
      restart: (settings, told) => this.#restart(settings, told),
    });
    this.device.addEventListener("input", () => this.#offer_modes());
    for (const input of [this.mode, this.exposure, this.exposure_ms, this.rotation, this.assumed]) {
      input.addEventListener("input", () => this.#write_command());
    }
    this.start.addEventListener("click", () =>
      this.#restart(this.#settings(), (told) => this.#told(told)),
    );
    dialog.addEventListener("close", () => this.calibration.stop());
  }

  async open() {
    this.dialog.showModal();
    this.words.value = "Looking for cameras …";
    try {
      const answer = await fetch(`cameras.json${location.search}`);
      if (!answer.ok) throw new Error(`${answer.status}`);
      this.#cameras = (await answer.json()).cameras;
      this.words.value = this.#cameras.length ? "" : "No camera is connected to the machine of the run.";
    } catch (error) {
      this.#cameras = [];
      this.words.value = `The list of cameras did not come: ${error.message}.`;
    }
    this.#offer_devices();
  }

  #offer_devices() {
    const now = values_of_source(this.#source);
    const options = this.#cameras.map(({ device, name, fault }) => {
      const words = `${device}: ${name}${fault ? ` (${fault})` : ""}`;
      return element("option", { value: device, textContent: words, disabled: Boolean(fault) });
    });
    this.device.replaceChildren(...options);
    if (this.#cameras.some(({ device }) => device === now.device)) this.device.value = now.device;
    const exposure_ms = now.exposure_ms ?? 0;
    this.exposure.value = exposure_ms < 0 ? "auto" : exposure_ms > 0 ? "manual" : "same";
    if (exposure_ms > 0) this.exposure_ms.value = exposure_ms;
    this.rotation.value = now.rotation_deg ?? 0;
    this.#offer_modes();
  }

  #camera() {
    return this.#cameras.find(({ device }) => String(device) === this.device.value) ?? null;
  }

  #offer_modes() {
    const modes = this.#camera()?.modes ?? [];
    const { width_px, height_px, format } = values_of_source(this.#source);
    const options = modes.map((mode, place) => new Option(mode_words(mode), place));
    this.mode.replaceChildren(new Option("as the camera file, else 640 x 480", ""), ...options);
    const place = modes.findIndex(
      (mode) => mode.width_px === width_px && mode.height_px === height_px && mode.format === format,
    );
    this.mode.value = place < 0 ? "" : place;
    const [least, most] = this.#camera()?.exposure_ms ?? [0.1, 10000];
    Object.assign(this.exposure_ms, { min: least, max: most });
    this.#write_command();
  }

  /** The settings of the choice, or null where there is no camera. */
  #settings() {
    const camera = this.#camera();
    if (!camera) return null;
    const exposures = { same: 0, auto: -1, manual: this.exposure_ms.valueAsNumber };
    return choice_settings(this.#source, {
      device: camera.device,
      mode: this.mode.value === "" ? null : camera.modes[this.mode.value],
      exposure_ms: exposures[this.exposure.value],
      rotation_deg: Number(this.rotation.value),
      is_assumed: this.assumed.checked,
    });
  }

  #write_command() {
    const is_manual = this.exposure.value === "manual";
    this.exposure_ms.disabled = !is_manual;
    const settings = this.#settings();
    this.start.disabled = !settings || (is_manual && !this.exposure_ms.checkValidity());
    this.command.textContent = settings ? `weft live ${option_words(settings)}` : "";
  }

  #restart(settings, told) {
    this.change_requests.now(`restart ${JSON.stringify(settings)}`, (answer) => {
      this.#restarts ||= answer.outcome === "granted";
      told(answer);
    });
  }

  #told(answer) {
    const granted = answer.outcome === "granted";
    this.words.value = granted ? "The run starts again …" : outcome_words(answer);
  }

  /** A run began. */
  begin_run() {
    if (this.#restarts) this.words.value = "The run has started again.";
    this.#restarts = false;
    this.calibration.begin_run();
  }

  /** Settings of the run, or null. */
  show_settings(settings) {
    this.#source = settings?.source ?? null;
    if (settings) this.calibration.source_told();
    if (this.dialog.open) this.#write_command();
  }

  calibration_told(state) {
    this.calibration.told(state);
  }

  /** A frame that came. */
  draw(frame, camera) {
    if (this.dialog.open) this.calibration.draw(frame, camera);
  }
}
