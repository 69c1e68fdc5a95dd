// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <weft/core/output_folder.hpp>
#include <weft/core/whole_file.hpp>
#include <weft/sdk/sink.hpp>

#include "common/inference/hash.hpp"
#include "common/output_folder/output_folder.hpp"
#include "grid_nodes.hpp"
#include "shard.hpp"
#include "small_frame.hpp"

namespace weft::shards {
namespace {

namespace fs = std::filesystem;

/// Writes small images and what they show, as arrays that NumPy maps into memory, for training.
class Shards final : public Sink {
 public:
  static constexpr About kAbout{.needs = "image ground_truth"};

  explicit Shards(Params& p) {
    p.output_path("path", path_, "folder of the shards, new or empty");
    p.read("width_px", format_.width_px, "px", {8, 4096}, "width of the small images");
    p.read("height_px", format_.height_px, "px", {8, 4096}, "height of the small images");
    p.read("cell_px", format_.cell_px, "px", {2, 64},
           "side of the cells, each with one label; even");
    p.read("columns", columns_, "", {2, 400}, "nodes of the grid along the width of the template");
    p.read("rows", rows_, "", {2, 400}, "nodes of the grid along its height");
    p.read("shard_frames", shard_frames_, "", {1, 1000000}, "number of frames in a shard");
  }

  void check(Mistakes& mistakes) const {
    if (format_.cell_px % 2 == 0) return;
    mistakes.expect("cell_px", Result<void>(Error{Errc::invalid_value,
                                                  "'cell_px' is odd: give an even number"}));
  }

  Result<void> prepare(const PrepareInput& in) override {
    if (!in.templ.m_per_px.present()) {
      return Error{Errc::invalid_data,
                   "the template has no m_per_px: use templates/rectangular, outline or mesh"};
    }
    const auto times = format_.reduction(in.camera);
    if (!times) return times.error();
    camera_ = format_.reduced(in.camera);
    texels_ = {static_cast<double>(in.templ.texture.dim(1)),
               static_cast<double>(in.templ.texture.dim(0))};
    pitch_m_ = {in.templ.m_per_px(0), in.templ.m_per_px(1)};
    texture_hash_ = inference::texture_hash(in.templ.texture);
    nodes_.emplace(node_places_m());
    return {};
  }

  Result<void> open(const Call&) override {
    for (const char* part : {"shards.json", "000000"}) {
      if (std::error_code ignored; !fs::exists(fs::path(path_) / part, ignored)) continue;
      return Error{Errc::io,
                   "the folder holds shards already: choose another 'path', or move them "
                   "away",
                   path_};
    }
    if (auto made = output_folder::make(path_); !made) return made;
    shard_.emplace(format_, std::int64_t{columns_} * rows_);
    shards_ = frames_ = 0;
    return write_description(std::nullopt);
  }

  Result<void> write(const SinkInput& in) override {
    const GroundTruth& truth = *in.ground_truth;
    if (!truth.uv_m.present() || !truth.depth_m.present()) {
      return no_result(
          "the truth has no depth and no template points of pixels: set 'dense_truth: true' in the "
          "source");
    }
    const CellLabels labels = cell_labels(format_, truth, pitch_m_, texels_);
    auto places = nodes_->at(truth);
    if (!places) return places.error();
    if (!is_there(labels, *places)) {
      std::fill(places->points_m.begin(), places->points_m.end(),
                std::numeric_limits<float>::quiet_NaN());
    }
    shard_->add(small_image(format_, *in.image), labels, *places);
    ++frames_;
    return shard_->count() < shard_frames_ ? Result<void>{} : write_shard();
  }

  /// The number of frames comes last: a description with it is complete.
  Result<void> finish(const Call&) override {
    if (!shard_) return {};
    if (shard_->count() > 0) {
      if (auto done = write_shard(); !done) return done;
    }
    if (auto done = output_folder::sync(path_); !done) return done;
    return write_description(frames_);
  }

 private:
  static bool is_there(const CellLabels& labels, const GridNodes::Places& places) {
    const auto any = [](const std::vector<std::uint8_t>& values) {
      return std::any_of(values.begin(), values.end(), [](std::uint8_t v) { return v != 0; });
    };
    return any(labels.mask) || any(places.visible);
  }

  Eigen::Vector2d size_m() const { return pitch_m_.cwiseProduct(texels_); }

  /// The nodes as in `template_xy_m`, which begins at the centre of the first texel.
  Points2 node_places_m() const {
    Points2 nodes_m(Eigen::Index{columns_} * rows_, 2);
    for (int r = 0; r < rows_; ++r) {
      for (int c = 0; c < columns_; ++c) {
        const Eigen::Vector2d share(static_cast<double>(c) / (columns_ - 1),
                                    static_cast<double>(r) / (rows_ - 1));
        nodes_m.row(Eigen::Index{r} * columns_ + c) =
            (share.cwiseProduct(size_m()) - 0.5 * pitch_m_).transpose();
      }
    }
    return nodes_m;
  }

  Result<void> write_description(std::optional<std::int64_t> frames) const {
    nlohmann::ordered_json text;
    text["format"] = "weft.shards/1";
    text["frames"] = frames ? nlohmann::ordered_json(*frames) : nlohmann::ordered_json(nullptr);
    text["image"] = {{"width_px", format_.width_px},
                     {"height_px", format_.height_px},
                     {"cell_px", format_.cell_px}};
    text["camera"] = {
        {"fx", camera_.fx}, {"fy", camera_.fy}, {"cx", camera_.cx}, {"cy", camera_.cy}};
    text["template"] = {{"width_m", size_m().x()},
                        {"height_m", size_m().y()},
                        {"columns", columns_},
                        {"rows", rows_},
                        {"texture_hash", texture_hash_}};
    return write_whole(text.dump(2) + "\n", fs::path(path_) / "shards.json");
  }

  Result<void> write_shard() {
    std::array<char, 24> name{};
    std::snprintf(name.data(), name.size(), "%06lld", static_cast<long long>(shards_));
    if (auto done = shard_->write(fs::path(path_) / name.data()); !done) return done;
    ++shards_;
    shard_->clear();
    return {};
  }

  std::string path_ = "shards";
  SampleFormat format_;
  int columns_ = 10, rows_ = 7;
  std::int64_t shard_frames_ = 1024;

  Camera camera_;
  Eigen::Vector2d texels_ = Eigen::Vector2d::Ones(), pitch_m_ = Eigen::Vector2d::Ones();
  std::string texture_hash_;
  std::optional<GridNodes> nodes_;
  std::optional<Shard> shard_;
  std::int64_t shards_ = 0, frames_ = 0;
};

}  // namespace
}  // namespace weft::shards

using weft::shards::Shards;
WEFT_PLUGIN(Shards, "sinks/shards", "1.0.0",
            "Writes small images with their template points, depth, mask and vertices as arrays "
            "for the training of networks.")
