// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <optional>
#include <weft/core/index.hpp>
#include <weft/core/quote.hpp>
#include <weft/data/owned.hpp>
#include <weft/sdk/sink.hpp>

#include "camera/calibrator.hpp"
#include "messages.hpp"
#include "server.hpp"
#include "token.hpp"

namespace weft::live {
namespace {

/// The run as it goes, for browsers and other programs: frames, what came of them, and a way to
/// change the run.
class Live final : public Sink {
 public:
  static constexpr About kAbout{
      .reads =
          "image time correspondences visibility shape other_shape ground_truth "
          "frame_report run_settings"};

  explicit Live(Params& p) {
    p.text("address", address_,
           "address of the server, as ADDRESS:PORT; port 0: a free port, for tests");
    p.text("token", token_,
           "access token of the clients, at least 16 letters and digits; required if other "
           "machines can reach the address; ${NAME} reads it from the environment");
    p.input_path("token_file", token_file_,
                 "file that contains the token, readable by its owner only; replaces 'token'");
    p.text("origin", origin_,
           "additional web origin that may connect, such as https://app.foxglove.dev");
    p.read("jpeg_quality", style_.quality, "", {1, 100},
           "JPEG quality of the images sent to clients");
    p.read("image_width_px", style_.width_px, "px", {0, 20'000},
           "maximum width of the images sent to clients; wider ones are scaled down; 0: no limit");
    p.output_path("camera_file", camera_file_,
                  "camera file that a calibration in the page writes; without it the page only "
                  "saves it in the browser");
  }

  void check(Mistakes& mistakes) const {
    const auto place = destination();
    if (!mistakes.expect("address", place)) return;
    const char* parameter = token_file_.empty() ? "token" : "token_file";
    const auto token = chosen_token();
    if (mistakes.expect(parameter, token)) {
      mistakes.expect(parameter, AccessPolicy(place->host, *token, origin_).check_token());
    }
    mistakes.expect("origin", AccessPolicy(place->host, "", origin_).check_origin());
  }

  Result<void> prepare(const PrepareInput& in) override {
    vertex_count_ = in.templ.vertices_m.rows();
    camera_ = in.camera;
    texture_width_px_ = static_cast<double>(in.templ.texture.dim(1));
    texture_height_px_ = static_cast<double>(in.templ.texture.dim(0));
    faces_.clear();
    for (std::int64_t f = 0; f < in.templ.faces.rows(); ++f) {
      faces_.insert(faces_.end(), in.templ.faces.row(f), in.templ.faces.row(f) + 3);
    }
    scene_ = scene_members(in.templ, in.camera);
    return {};
  }

  Result<void> open(const Call& call) override {
    const auto place = destination();
    if (!place) return place.error();
    const auto token = chosen_token();
    if (!token) return token.error();
    LiveSetup setup{
        AccessPolicy(place->host, *token, origin_), style_, camera_, faces_, scene_, {}};
    if (auto fits = setup.policy.check_token(); !fits) return fits;
    if (auto fits = setup.policy.check_origin(); !fits) return fits;
    calibrator_ = make_calibrator(camera_file_, [this](std::string state) {
      run_channel_.put_calibration(std::move(state));
    });
    setup.calibrator = calibrator_.get();
    auto started = start_server(*place, std::move(setup), run_channel_);
    if (!started) return started.error();
    server_ = *std::move(started);
    opened_ = std::chrono::steady_clock::now();
    call.log_info("the live view is at " + url(*place) + (token->empty() ? "" : "?token=..."));
    return {};
  }

  Result<void> write(const SinkInput& in) override {
    if (!server_) return Error{Errc::io, "the live view is not open"};
    for (const auto* shape : {&in.shape, &in.other_shape}) {
      if (!*shape) continue;
      if (auto fits = check_shape(**shape); !fits) return fits;
    }
    if (in.run_settings && in.run_settings->revision != settings_revision_) {
      settings_revision_ = in.run_settings->revision;
      run_channel_.put_settings(in.run_settings->json);
    }
    if (in.frame_report && run_channel_.is_read()) run_channel_.put_line(in.frame_report->json);
    if (in.image && calibrator_->wants_frame() && run_channel_.is_watched()) {
      calibrator_->put_frame(in.image->pixels, in.call.frame());
    }
    if (run_channel_.is_watched()) {
      run_channel_.put_frame(shown_of(in));
    } else {
      run_channel_.pass_frame();
    }
    ++written_;
    return {};
  }

  Result<void> finish(const Call&) override {
    if (server_) server_->finish();
    server_.reset();
    calibrator_.reset();
    return {};
  }

  std::vector<ChangeRequest> take_change_requests() { return run_channel_.take_change_requests(); }
  void answer(const ChangeAnswer& answer) { run_channel_.answer(answer); }

 private:
  Result<std::string> chosen_token() const {
    if (token_file_.empty()) return token_;
    if (token_.empty()) return token_in(token_file_);
    return Error{Errc::invalid_value, "give 'token' or 'token_file', not both"};
  }

  Result<network::Address> destination() const {
    auto place = network::parse_address(address_, 0);
    if (place) return place;
    return Error{Errc::invalid_value, quote(address_) + " " + place.error().message +
                                          "; write 127.0.0.1:8090, [::1]:8090 or localhost:8090"};
  }

  std::string url(const network::Address& place) const {
    std::string host = place.host.to_string();
    if (place.host.is_v6()) host = "[" + host + "]";
    if (place.host.is_unspecified()) host = "<address of this machine>";
    return "http://" + host + ":" + std::to_string(server_->port()) + "/";
  }

  Result<void> check_shape(const Shape& shape) const {
    if (shape.vertices_m.rows() == vertex_count_) return {};
    return Error{Errc::invalid_data, "the shape has " + std::to_string(shape.vertices_m.rows()) +
                                         " vertices, the template " +
                                         std::to_string(vertex_count_)};
  }

  FrameCopy shown_of(const SinkInput& in) const {
    FrameCopy shown;
    shown.frame = in.call.frame();
    const std::chrono::nanoseconds since_open = std::chrono::steady_clock::now() - opened_;
    shown.taken_ns = static_cast<std::uint64_t>(since_open.count());
    shown.written = written_;
    if (in.time) shown.time_s = in.time->t_s;
    if (in.image) shown.pixels = owned(in.image->pixels);
    if (in.frame_report) shown.report = in.frame_report->json;
    if (in.correspondences) {
      shown.matches = copy_of(*in.correspondences, texture_width_px_, texture_height_px_);
    }
    if (in.ground_truth) shown.truth_m = points_of(*in.ground_truth);
    if (in.other_shape) shown.other_m = vertices_of(*in.other_shape);
    if (!in.shape) return shown;
    shown.state = in.shape->shape_state();
    shown.vertices_m = vertices_of(*in.shape);
    if (in.visibility && in.visibility->visible.rows() == vertex_count_) {
      for (std::int64_t v = 0; v < vertex_count_; ++v) {
        shown.visible.push_back(in.visibility->visible(v));
      }
    }
    return shown;
  }

  std::string address_ = "127.0.0.1:8090", token_, token_file_, origin_, camera_file_;
  PictureStyle style_;

  std::int64_t vertex_count_ = 0;
  double texture_width_px_ = 0.0, texture_height_px_ = 0.0;
  Camera camera_;
  std::vector<std::int32_t> faces_;
  std::string scene_;
  std::optional<std::uint64_t> settings_revision_;
  std::uint64_t written_ = 0;  ///< [] frames
  RunChannel run_channel_;     // outlives the calibrator and the server
  std::unique_ptr<Calibrator> calibrator_;
  std::unique_ptr<Server> server_;
  std::chrono::steady_clock::time_point opened_;
};

}  // namespace
}  // namespace weft::live

using weft::live::Live;
WEFT_PLUGIN(
    Live, "sinks/live", "1.0.0",
    "Serves a live view of the run to browsers and other programs, which can also change it.")
