// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/data/record.hpp>

namespace weft {

/// A smooth map from the template's texture to the image. Only its producer reads the model.
struct Warp {
  static constexpr const char* kType = "warp/1";
  std::string producer;             ///< [n] id of the component that can evaluate it
  Array<double> domain_px;          ///< [4] u0 u1 v0 v1, px of the texture
  NamedArrays model{"model.", {}};  ///< model parameters, private to the producer
  Diagnostics diag;
  std::uint64_t producer_handle = 0;  ///< handle of the producer; set by the host
  Others others = {};                 ///< further arrays of the record

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit(self.producer, Field{"producer", "*", "", "id of the component that can evaluate it"});
    visit(self.domain_px, Field{"domain_px", "4", "px of the texture", "u0 u1 v0 v1"});
    visit(self.model, Field{"model.*", "*", "", "read by the producer only", true});
    visit(self.diag, Field{"diag.*", "*", "", "evidence", true});
  }
};

/// Points at which a warp is evaluated.
struct Points {
  static constexpr const char* kType = "points/1";
  Array<double> xy_px;     ///< [M,2] px of the texture
  std::int64_t order = 0;  ///< [] highest requested derivative, 0 to 2
  Others others = {};      ///< further arrays of the record

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit(self.xy_px, Field{"xy_px", "M,2", "px of the texture", "where to evaluate"});
    visit(self.order, Field{"order", "", "", "highest derivative wanted, 0 to 2"});
  }
};

/// Values and derivatives of a warp.
struct WarpSamples {
  static constexpr const char* kType = "warp_samples/1";
  Array<double> xy_px;        ///< [M,2] px of the image
  Array<double> jacobian;     ///< [M,2,2] d(x,y)/d(u,v), px per px
  Array<double> hessian;      ///< [M,2,3] d2/duu d2/duv d2/dvv of x and of y, 1/px
  Array<std::uint8_t> valid;  ///< [M] 0 where the warp was extrapolated or is not finite
  Others others = {};         ///< further arrays of the record

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit(self.xy_px, Field{"xy_px", "M,2", "px", "image points", false, true});
    visit(self.jacobian, Field{"jacobian", "M,2,2", "px/px", "d(x,y)/d(u,v)", true, true});
    visit(self.hessian, Field{"hessian", "M,2,3", "1/px", "duu duv dvv of x and of y", true, true});
    visit(self.valid, Field{"valid", "M", "0 or 1", "0 where extrapolated or not finite"});
  }
};

}  // namespace weft
