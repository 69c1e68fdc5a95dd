// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <weft/data/matrix.hpp>
#include <weft/sdk/source.hpp>

#include "arm.hpp"
#include "backdrop.hpp"
#include "common/scene/sensor.hpp"
#include "common/scene/sheet_renderer.hpp"
#include "degradation.hpp"
#include "film/film.hpp"
#include "film/view_truth.hpp"
#include "lamp.hpp"
#include "settings.hpp"

namespace weft::frex {

/// A textured object that moves, ray-cast, with the ground truth of each pixel and vertex.
class FilmSource : public Source {
 public:
  void check(Mistakes& mistakes) const { settings_.check(mistakes); }

  Result<Camera> open(const Call& call) override;
  std::int64_t count() const override { return settings_.frames; }
  Result<SourceFrame> read(std::int64_t index, const Call& call) override;

 protected:
  /// Builds the object and its movement when the source is opened.
  virtual Result<Subject> make_subject(const Call& call) const = 0;

  Settings settings_;  ///< its constructor reads them

 private:
  /// The objects that are ready once the source is open.
  struct Studio {
    scene::SheetRenderer renderer;
    Pinhole pinhole;
    std::unique_ptr<Film> film;
    Lamp lamp;
    std::optional<Arm> arm;
    scene::Sensor sensor;
    bool is_grey;
    TruthFrame truth;
  };

  Result<Studio> furnish(const Camera& camera, Subject&& subject) const;
  Result<Picture> make_backdrop(const Camera& camera, const scene::MipTexture& print,
                                double pitch_m) const;
  std::int64_t cuts_until(std::int64_t index) const;
  Result<Movement> movement_at(std::int64_t moment, const Call& call);
  scene::View look(std::int64_t index, double t_s, const FilmState& state,
                   const std::optional<Movement>& movement);
  Result<Image> picture(std::int64_t index, const std::optional<Movement>& movement,
                        scene::Picture& light) const;
  GroundTruth truth(const FilmState& state, const scene::View& view) const;

  std::optional<Studio> studio_;
};

}  // namespace weft::frex
