// SPDX-License-Identifier: Apache-2.0
// The settings of the run's source that choose and calibrate a camera.

const kVideo = "sources/video";

/** Values of the parameters of a source {id, parameters}, by their names without "source.". */
export function values_of_source(source) {
  const parameters = source?.parameters ?? [];
  return Object.fromEntries(
    parameters.map(({ setting, value }) => [setting.replace(/^source\./, ""), value]),
  );
}

const setting = (name, value) => `source.${name}=${JSON.stringify(value)}`;

/** The settings that choose a camera: {device, mode: {format, width_px, height_px} or null,
    exposure_ms (0: as it is set, below 0: automatic), rotation_deg, is_assumed: without a camera
    file}, in place of what the source takes now. */
export function choice_settings(source, { device, mode, exposure_ms, rotation_deg, is_assumed }) {
  const now = source?.id === kVideo ? values_of_source(source) : {};
  const settings = source?.id === kVideo ? [] : [`source.use=${kVideo}`];
  for (const name of ["path", "address"]) if (now[name]) settings.push(setting(name, ""));
  settings.push(setting("device", device));
  const { format = "", width_px = 0, height_px = 0 } = mode ?? {};
  settings.push(setting("format", format));
  settings.push(setting("width_px", width_px), setting("height_px", height_px));
  settings.push(setting("exposure_ms", exposure_ms), setting("rotation_deg", rotation_deg));
  if (is_assumed || source?.id !== kVideo) settings.push(setting("camera", "auto"));
  return settings;
}

/** What a source does to its images before the run sees them, and so the page. Calibration needs
    the images of the sensor: the settings for these, and those that restore the present ones with
    a camera file. Null where the images are those of the sensor. */
export function raw_settings(source) {
  const { camera, longest_px, rotation_deg } = values_of_source(source);
  const has_camera = Boolean(camera) && camera !== "auto";
  if (!has_camera && !longest_px && !rotation_deg) return null;
  const settings = [setting("camera", "auto")];
  if (longest_px) settings.push(setting("longest_px", 0));
  if (rotation_deg) settings.push(setting("rotation_deg", 0));
  return settings;
}

/** The settings of a run with a camera file; `before` is the source before raw_settings(), or
    null. */
export function calibrated_settings(path, before) {
  const { longest_px, rotation_deg } = values_of_source(before);
  const settings = [setting("camera", path)];
  if (longest_px) settings.push(setting("longest_px", longest_px));
  if (rotation_deg) settings.push(setting("rotation_deg", rotation_deg));
  return settings;
}

/** "1280 x 720, MJPG, 30 a second". */
export function mode_words({ format, width_px, height_px, fps }) {
  const rate = fps > 0 ? `, ${Number(fps.toFixed(1))} a second` : "";
  return `${width_px} x ${height_px}, ${format}${rate}`;
}

/** The options with which `weft live` starts such a run. */
export const option_words = (settings) =>
  settings.map((each) => `--set '${each.replaceAll("'", "'\\''")}'`).join(" ");

/** What the state of a calibration says, in one sentence or two. */
export function calibration_words(state) {
  switch (state?.state) {
    case "collecting": {
      const seen = state.corners_px ? "" : state.reason ? ` Not in this frame: ${state.reason}.` : "";
      const missing = state.missing[0];
      const next = missing ? `Next: ${missing}.` : "These are enough.";
      return `${state.views} of ${state.enough} views. ${next}${seen}`;
    }
    case "solving":
      return `Estimating the camera from ${state.views} views …`;
    case "done": {
      const odd = state.odd.length ? ` Excluded: ${state.odd.join(", ")}.` : "";
      const fx = `${state.fx.toFixed(1)} ± ${state.fx_deviation.toPrecision(2)} px`;
      const place = state.path ? ` Written: ${state.path}.` : "";
      const why = state.reason ? ` Not written: ${state.reason}.` : "";
      const error = `error ${state.rms_px.toFixed(3)} px`;
      return `${state.used} views, ${error}, focal length ${fx}.${odd}${place}${why}`;
    }
    case "failed":
      return `No camera: ${state.reason}`;
    default:
      return "";
  }
}
