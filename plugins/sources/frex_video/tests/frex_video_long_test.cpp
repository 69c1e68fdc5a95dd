// SPDX-License-Identifier: Apache-2.0
// The accuracy over a whole film; the quick tests look at one of these frames.
#include "film_accuracy.hpp"

namespace weft::testing {
namespace {

constexpr int kFilm[] = {0, 17, 34, 58, 91, 133, 170};

TEST(FrexFilm, ShowsThePrintAsIfItHadBeenFilmed) {
  FilmedSheet filmed;
  expect_the_print_as_if_filmed(filmed, kFilm, 400'000U);
}

TEST(FrexFilm, KnowsTheSurfaceBetterThanEachMarkerByItself) {
  const FilmedSheet filmed;
  expect_the_surface_to_be_known(filmed, kFilm);
}

}  // namespace
}  // namespace weft::testing
