// SPDX-License-Identifier: Apache-2.0
// Checks of sources, templates and sinks, the components at the ends of a pipeline.
#include <fstream>
#include <sstream>
#include <weft/data/matrix.hpp>
#include <weft/geometry/camera_check.hpp>
#include <weft/geometry/mesh_validation.hpp>
#include <weft/geometry/solid/validation.hpp>

#include "kit/testing/contract_outputs.hpp"
#include "kit/testing/contract_stages.hpp"

namespace weft::testing {
namespace {

Answer open_source(Performer& performer) { return performer.call(kOpenSource, {}); }

Answer read_frame(Performer& performer, std::int64_t frame) {
  return performer.call(kReadFrame, {}, static_cast<std::uint64_t>(frame));
}

void check_frame(const Subject& subject, const Camera& camera, const Answer& frame,
                 Checks& checks) {
  check_answer(frame, checks);
  if (!frame.is_usable()) return checks.fail("reports " + to_text(frame));
  checks.expect(!frame.outputs.empty(), "reports " + to_text(frame) + " and gives nothing");
  for (const auto& [slot, record] : frame.outputs) {
    checks.expect(subject.produces(slot), "it gives '" + slot + "', which it does not announce");
  }
  if (const auto image = frame.get<Image>("image")) {
    const bool fits =
        image->pixels.dim(0) == camera.height_px && image->pixels.dim(1) == camera.width_px;
    checks.expect(fits, "the size of the image differs from that of the camera");
  }
  if (const auto matches = frame.get<Correspondences>("correspondences")) {
    for (std::int64_t i = 0; i < matches->count(); ++i) {
      if (matches->kept(i) != 1) return checks.fail("a match is not marked as kept");
    }
  }
}

/// Returns the camera if the source could be opened.
std::optional<Camera> check_open(Performer& performer, Checks& checks) {
  checks.begin("opened");
  const Answer opened = open_source(performer);
  check_answer(opened, checks);
  const auto camera = opened.get<Camera>("camera");
  if (!camera) {
    checks.fail("reports " + to_text(opened));
    return std::nullopt;
  }
  const auto mistake = camera_mistake(*camera);
  checks.expect(!mistake, mistake ? "of the camera, " + mistake->message : "");
  return *camera;
}

std::string content_of(const std::filesystem::path& file) {
  std::ostringstream content;
  content << std::ifstream(file, std::ios::binary).rdbuf();
  return content.str();
}

/// Contents by path below the folder.
std::map<std::string, std::string> files_in(const std::filesystem::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    files[std::filesystem::relative(entry.path(), folder).string()] = content_of(entry.path());
  }
  return files;
}

using Files = std::map<std::string, std::string>;

/// The files that it writes for this number of frames; optional inputs are given in every other
/// frame alone.
Files write_frames(const FindIn& find, int frames, Checks& checks) {
  const ScratchFolder folder;
  const auto subject = find(folder.path().string());
  if (!subject) {
    checks.fail(subject.error().message);
    return {};
  }
  const auto cases = cases_of(*subject);
  Performer performer(*subject);
  const auto done = [&](const char* what, const Answer& answer) {
    check_answer(answer, checks);
    if (!answer.is_usable()) checks.fail(std::string(what) + " reports " + to_text(answer));
    return answer.is_usable();
  };
  if (auto ready = performer.begin(cases[0].scene.templ, cases[0].scene.camera); !ready) {
    checks.fail(ready.error().message);
    return {};
  }
  bool all_done = done("open", performer.call(kOpenSink, {}));
  for (int frame = 0; all_done && frame < frames; ++frame) {
    const auto number = static_cast<std::uint64_t>(frame);
    all_done = done("write", performer.call(kWriteFrame, cases[number % 2].inputs, number));
  }
  if (all_done) done("finish", performer.call(kFinishSink, {}));
  return files_in(folder.path());
}

}  // namespace

void check_source(const Subject& subject, Checks& checks) {
  Performer performer(subject);
  const Scene scene = make_scene(0, subject.seed);
  if (auto made = performer.begin(scene.templ, scene.camera); !made) return;  // already reported
  const auto camera = check_open(performer, checks);
  if (!camera) return;
  checks.begin("counted");
  const Answer counted = performer.call(kCountFrames, {});
  const auto count = counted.get<Count>("count");
  if (!count) return checks.fail("reports " + to_text(counted));
  checks.expect(count->frames != 0 && count->frames >= -1,
                "there are " + std::to_string(count->frames) + " frames; give it some to read");
  const std::int64_t last = count->frames > 0 ? count->frames - 1 : 0;

  checks.begin("the first frame");
  const Answer first = read_frame(performer, 0);
  check_frame(subject, *camera, first, checks);
  checks.begin("the last frame");
  const Answer end = read_frame(performer, last);
  check_frame(subject, *camera, end, checks);
  if (subject.is_exact()) {
    checks.begin("read in another order");
    Performer other(subject);
    if (!other.begin(scene.templ, scene.camera) || !open_source(other).is_usable()) {
      return checks.fail("it cannot be opened again");
    }
    const std::string of_last = difference(read_frame(other, last), end);
    checks.expect(of_last.empty(), "of the last frame, " + of_last);
    const std::string of_first = difference(read_frame(other, 0), first);
    checks.expect(of_first.empty(), "of the first frame, " + of_first);
  }
  check_cancelling(
      subject, scene, open_source, [&](Performer& p) { return read_frame(p, last); }, checks);
}

void check_template(const Subject& subject, Checks& checks) {
  const auto build = [](Performer& performer) { return performer.call(kBuildTemplate, {}); };
  Performer performer(subject);
  const Scene scene = make_scene(0, subject.seed);
  if (!performer.begin(scene.templ, scene.camera)) return;  // already reported
  checks.begin("built");
  const Answer built = build(performer);
  check_answer(built, checks);
  const auto templ = built.get<Template>("template");
  if (!templ) return checks.fail("reports " + to_text(built));
  const auto faces = templ->faces.matrix<3>();
  const auto mesh = validate_mesh(templ->vertices_m.matrix<3>(), faces);
  if (!mesh) return checks.fail(mesh.error().message);
  const auto flat = validate_flat_mesh(templ->flat_px.matrix<2>(), faces);
  if (!flat) checks.fail(flat.error().message);
  const auto solid = validate_solid(*templ);
  if (!solid) checks.fail(solid.error().message);
  checks.expect(templ->texture.dim(0) == templ->mask.dim(0) &&
                    templ->texture.dim(1) == templ->mask.dim(1) && templ->texture.size() > 0,
                "its mask has not the size of its texture");
  if (subject.is_exact()) {
    checks.begin("built again");
    const std::string how = difference(build(performer), built);
    checks.expect(how.empty(), how);
  }
  check_cancelling(subject, scene, {}, build, checks);
}

void check_sink(const FindIn& find, Checks& checks) {
  checks.begin("two frames");
  const Files first = write_frames(find, 2, checks);
  bool is_empty = false;
  for (const auto& [file, content] : first) is_empty = is_empty || content.empty();
  checks.expect(!is_empty, "it leaves an empty file");
  checks.begin("two frames again");
  checks.expect(write_frames(find, 2, checks) == first, "it writes other files");
  checks.begin("no frame");
  write_frames(find, 0, checks);
}

}  // namespace weft::testing
