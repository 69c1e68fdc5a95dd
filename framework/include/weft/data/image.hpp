// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/data/record.hpp>

namespace weft {

/// One undistorted frame. Pixel centres are at integer coordinates.
struct Image {
  static constexpr const char* kType = "image/1";
  Array<std::uint8_t> pixels;  ///< [H,W] grey levels or [H,W,3] BGR, 0 to 255
  std::string stem;            ///< [n] name of the frame without folder and extension
  Others others = {};          ///< further arrays of the record

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit(self.pixels, Field{"pixels", "H,W,?", "grey level or BGR", "the undistorted image"});
    visit(self.stem, Field{"stem", "*", "", "file name without folder and extension"});
  }
};

/// Capture time of the frame.
struct Time {
  static constexpr const char* kType = "time/1";
  double t_s = 0.0;    ///< [] s since the first frame
  Others others = {};  ///< further arrays of the record

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit(self.t_s, Field{"t_s", "", "s", "time since the first frame"});
  }
};

/// Number of frames of a source.
struct Count {
  static constexpr const char* kType = "count/1";
  std::int64_t frames = -1;  ///< [] number of frames; -1 if unknown (camera, stream)
  std::int64_t live = 0;     ///< [] 1 if frames arrive on their own, as from a camera
  Others others = {};        ///< further arrays of the record

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit(self.frames, Field{"frames", "", "", "number of frames, -1 when unknown"});
    visit(self.live, Field{"live", "", "0 or 1", "1 where frames come by themselves", true});
  }
};

/// The part of an image that components may use.
struct Region {
  static constexpr const char* kType = "region/1";
  Array<std::uint8_t> mask;  ///< [H,W] 1 where the image may be used, else 0
  Others others = {};        ///< further arrays of the record

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit(self.mask, Field{"mask", "H,W", "0 or 1", "1 where the image may be used"});
  }
};

/// The pixels that show the object. Its outline is where the foreground, interpolated linearly
/// between pixel centres, is 128. Next to an occluder the outline of the foreground is not that of
/// the object: such pixels are unknown.
struct ObjectMask {
  static constexpr const char* kType = "object_mask/1";
  Array<std::uint8_t> foreground;  ///< [H,W] certainty, 0 background to 255 object
  Array<std::uint8_t> known;       ///< [H,W] 0 where the foreground says nothing, else 1
  Diagnostics diag;
  Others others = {};  ///< further arrays of the record

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit(self.foreground, Field{"foreground", "H,W", "0 to 255",
                                 "certainty that the pixel shows the object; 128 on its outline"});
    visit(self.known,
          Field{"known", "H,W", "0 or 1", "0 where that is not known, as next to occluders"});
    visit(self.diag, Field{"diag.*", "*", "", "evidence", true});
  }
};

}  // namespace weft
