// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cstdio>
#include <filesystem>
#include <weft/core/output_folder.hpp>
#include <weft/core/whole_file.hpp>
#include <weft/data/owned.hpp>
#include <weft/data/record_view.hpp>
#include <weft/sdk/sink.hpp>

#include "common/output_folder/output_folder.hpp"
#include "description.hpp"
#include "output_file.hpp"

namespace weft::dataset {
namespace {

namespace fs = std::filesystem;

/// The members of one record, as an archive of this record alone.
template <class RecordType>
std::vector<NpzMember> members_of(const char* slot, const RecordType& typed) {
  std::vector<NpzMember> members;
  add_npz_members(RecordView(slot, typed).raw(), members);
  return members;
}

/// Writes images, camera, template and truth as a sequence that sources/images reads back.
class Dataset final : public Sink {
 public:
  static constexpr About kAbout{.needs = "image", .reads = "time ground_truth"};

  explicit Dataset(Params& p) {
    p.output_path("path", path_, "folder of the sequence");
    p.read("dense_truth", dense_truth_,
           "depth and template point of each pixel in the sequence, if known");
  }

  Result<void> prepare(const PrepareInput& in) override {
    camera_ = in.camera;
    texture_ = owned(in.templ.texture);
    template_members_ = members_of("template", in.templ);
    // Only numbers are needed later.
    templ_ = Template{};
    templ_.flat_px = owned(in.templ.flat_px);
    templ_.m_per_px = owned(in.templ.m_per_px);
    templ_.texture = texture_;
    return {};
  }

  Result<void> open(const Call&) override {
    contents_ = {};
    const fs::path folder(path_);
    for (const char* part : {"frames", "gt", "template"}) {
      if (!is_free_for_folder(folder / part)) {
        return Error{Errc::io,
                     (folder / part).string() +
                         " holds files already: choose another 'path', or move them away"};
      }
      const std::error_code status = make_folders(folder / part);
      if (status) {
        return Error{Errc::io, "the folder " + (folder / part).string() + " cannot be made (" +
                                   status.message() + "): choose another 'path'"};
      }
    }
    if (auto done = write_whole(camera_text(camera_), folder / "camera.yaml"); !done) return done;
    if (auto done = write_png(folder / "template/texture.png", texture_); !done) return done;
    return write_npz(folder / "template/template.npz", template_members_);
  }

  Result<void> write(const SinkInput& in) override {
    const fs::path folder(path_);
    const std::string name = name_of(in.call.frame());
    // Truth first: a frame that is there has its truth.
    if (in.ground_truth) {
      if (auto done = write_truth(folder / "gt" / (name + ".npz"), *in.ground_truth); !done) {
        return done;
      }
    }
    if (auto done = write_png(folder / "frames" / (name + ".png"), in.image->pixels); !done) {
      return done;
    }
    if (in.time && contents_.frames == 0) contents_.first_s = in.time->t_s;
    if (in.time) contents_.last_s = in.time->t_s;
    ++contents_.frames;
    return {};
  }

  /// The description comes last: a folder with meta.yaml is complete.
  Result<void> finish(const Call&) override {
    const fs::path folder(path_);
    if (contents_.frames == 0) return {};
    if (auto done = write_whole(sequence_text(templ_, contents_), folder / "sequence.yaml");
        !done) {
      return done;
    }
    if (auto done = output_folder::sync(path_); !done) return done;
    return write_whole(meta_text(camera_, templ_, contents_), folder / "meta.yaml");
  }

 private:
  static std::string name_of(std::uint64_t frame) {
    std::array<char, 24> name{};
    std::snprintf(name.data(), name.size(), "%06llu", static_cast<unsigned long long>(frame));
    return name.data();
  }

  Result<void> write_truth(const fs::path& path, const GroundTruth& given) {
    GroundTruth truth = given;
    if (!dense_truth_) {
      truth.depth_m = {};
      truth.uv_m = {};
    }
    if (auto done = write_npz(path, members_of("ground_truth", truth)); !done) return done;
    if (contents_.frames_with_truth == 0) contents_.truth_kind = truth.kind;
    ++contents_.frames_with_truth;
    return {};
  }

  std::string path_ = "sequence";
  bool dense_truth_ = true;

  Camera camera_;
  Template templ_;
  Array<std::uint8_t> texture_;
  std::vector<NpzMember> template_members_;
  Contents contents_;
};

}  // namespace
}  // namespace weft::dataset

using weft::dataset::Dataset;
WEFT_PLUGIN(Dataset, "sinks/dataset", "1.0.0",
            "Writes images, camera, template and ground truth as a sequence that sources can read.")
