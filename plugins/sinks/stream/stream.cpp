// SPDX-License-Identifier: Apache-2.0
#include <limits>
#include <weft/data/matrix.hpp>
#include <weft/sdk/sink.hpp>

#include "messages.hpp"
#include "outlet.hpp"

namespace weft::stream {
namespace {

enum class Format { json_lines, packed };

/// The vertices of each frame as one message, to programs that read while the pipeline runs.
class Stream final : public Sink {
 public:
  static constexpr About kAbout{.needs = "shape", .reads = "time"};

  explicit Stream(Params& p) {
    p.text("to", to_,
           "destination of the stream; tcp://ADDRESS:PORT accepts readers; udp://ADDRESS:PORT "
           "sends to one reader");
    p.output_path("path", path_, "file, named pipe or /dev/stdout that replaces 'to'");
    p.choice("format", format_, {{"json_lines", Format::json_lines}, {"packed", Format::packed}},
             "format of the stream; json_lines: one JSON object per line; packed: binary");
    p.read("covariance", covariance_,
           "covariance of each vertex in the stream, if the solver provides it");
  }

  void check(Mistakes& mistakes) const { mistakes.expect("to", destination()); }

  Result<void> prepare(const PrepareInput& in) override {
    vertex_count_ = in.templ.vertices_m.rows();
    return {};
  }

  Result<void> open(const Call&) override {
    const auto address = destination();
    if (!address) return address.error();
    MadeOutlet made = to_.empty()                          ? open_path(path_)
                      : address->protocol == Protocol::tcp ? listen_at(*address, to_)
                                                           : send_to(*address, to_);
    if (!made) return made.error();
    outlet_ = *std::move(made);
    return {};
  }

  Result<void> write(const SinkInput& in) override {
    const Shape& shape = *in.shape;
    if (auto fits = check_shape(shape); !fits) return fits;
    const FramePoints points{in.call.frame(),
                             in.time ? in.time->t_s : std::numeric_limits<double>::quiet_NaN(),
                             shape, covariance_};
    return outlet_->send(format_ == Format::packed ? packed(points) : json_line(points), in.call);
  }

  Result<void> finish(const Call&) override {
    if (outlet_) outlet_->finish();
    outlet_.reset();
    return {};
  }

 private:
  /// Where points go to; of a path nothing.
  Result<Address> destination() const {
    if (to_.empty() != path_.empty()) return to_.empty() ? Address{} : parse_address(to_);
    return Error{Errc::invalid_value,
                 (to_.empty() ? "has neither 'to' nor 'path'; " : "has both 'to' and 'path'; ") +
                     std::string("give one of them, such as to: tcp://127.0.0.1:5005")};
  }

  Result<void> check_shape(const Shape& shape) const {
    if (shape.vertices_m.rows() != vertex_count_) {
      return Error{Errc::invalid_data, "the shape has " + std::to_string(shape.vertices_m.rows()) +
                                           " vertices, the template " +
                                           std::to_string(vertex_count_)};
    }
    const auto covariance = shape.covariance_m2.matrix<9>();
    if (!shape.vertices_m.matrix<3>().allFinite() || !covariance.allFinite()) {
      return Error{Errc::invalid_data, "the shape has a number that is not finite"};
    }
    return {};
  }

  std::string to_, path_;
  Format format_ = Format::json_lines;
  bool covariance_ = true;

  std::int64_t vertex_count_ = 0;
  std::unique_ptr<Outlet> outlet_;
};

}  // namespace
}  // namespace weft::stream

using weft::stream::Stream;
WEFT_PLUGIN(Stream, "sinks/stream", "1.0.0",
            "Streams the points of each frame to other programs while the pipeline runs.")
