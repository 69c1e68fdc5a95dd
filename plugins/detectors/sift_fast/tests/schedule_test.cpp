// SPDX-License-Identifier: Apache-2.0
#include "schedule.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <tuple>
#include <vector>
#include <weft/core/index.hpp>

namespace weft::sift_fast {
namespace {

std::vector<Settings> various_settings() {
  std::vector<Settings> all(3);
  all[1].upsample = false;
  all[2].octave_layers = 1;
  all[2].sigma_px = 8.0;  // kernels that reach beyond small octaves
  return all;
}

TEST(Kernels, MakeOneAndHaveTheVarianceOfTheGaussian) {
  for (const double sigma_px : {0.6, 1.2, 1.5, 3.1, 20.0}) {
    const Taps taps = gaussian(sigma_px);
    EXPECT_EQ(std::accumulate(taps.begin(), taps.end(), 0), kOne) << sigma_px;
    double variance = 0.0;
    for (std::size_t i = 1; i < taps.size(); ++i) {
      variance += static_cast<double>(i * i) * taps[i] / kOne;
    }
    EXPECT_NEAR(std::sqrt(variance) / sigma_px, 1.0, 0.01) << sigma_px;

    const std::vector<std::int16_t> doubling = doubling_gaussian(sigma_px);
    EXPECT_EQ(std::accumulate(doubling.begin(), doubling.end(), 0), kOne) << sigma_px;
    // An even sample of the enlarged row lies a quarter of a pixel before that of the row.
    const auto middle = static_cast<double>(doubling.size() / 2);
    double mean = 0.0;
    for (std::size_t i = 0; i < doubling.size(); ++i) {
      mean += (static_cast<double>(i) - middle) * doubling[i] / kOne;
    }
    EXPECT_NEAR(mean, -0.25, 0.01) << sigma_px;
  }
}

TEST(Schedule, HasEveryRowOnceAndEachTaskAfterThoseThatItNeeds) {
  for (const Settings& each : various_settings()) {
    const Blurs blurs(each);
    Pyramid pyramid;
    Schedule schedule;
    for (const auto& [width, height] : {std::pair{97, 61}, std::pair{640, 480}, std::pair{12, 300},
                                        std::pair{5, 5}, std::pair{1, 1}}) {
      pyramid.resize(width, height, each.upsample, blurs.layers);
      schedule.make(pyramid, blurs);
      std::set<int> done;
      std::map<std::tuple<Task::Kind, int, int>, int> rows;
      for (const Task& task : schedule.tasks()) {
        for (int needed = task.first_needed; needed < task.end_needed; ++needed) {
          EXPECT_TRUE(done.count(needed) == 1) << width << " x " << height;
        }
        EXPECT_TRUE(done.insert(task.id).second);
        int& next = rows[{task.kind, task.octave, task.layer}];
        EXPECT_EQ(task.rows.begin, next);
        next = task.rows.end;
      }
      EXPECT_EQ(static_cast<int>(done.size()), schedule.count());
      for (int o = 0; o < pyramid.octaves(); ++o) {
        const int all = pyramid.octave(o).height();
        EXPECT_EQ((rows[{Task::Kind::search, o, 0}]), all);
        for (int l = 0; l < blurs.layers; ++l) {
          EXPECT_EQ((rows[{Task::Kind::blur, o, l}]), all) << "octave " << o << " layer " << l;
        }
      }
      EXPECT_EQ(schedule.count() == 0, pyramid.octaves() == 0);
    }
  }
}

/// Rows of the layer before that a blur of `rows` reads, mirrored, are among those that its task
/// waits for.
TEST(Schedule, WaitsForAllRowsThatABlurReads) {
  for (const Settings& each : various_settings()) {
    const Blurs blurs(each);
    Pyramid pyramid;
    Schedule schedule;
    pyramid.resize(90, 70, each.upsample, blurs.layers);
    schedule.make(pyramid, blurs);
    std::map<int, RowRange> rows_of;
    for (const Task& task : schedule.tasks()) rows_of[task.id] = task.rows;
    for (const Task& task : schedule.tasks()) {
      if (task.kind != Task::Kind::blur || task.layer == 0) continue;
      const int height = pyramid.octave(task.octave).height();
      const auto reach = static_cast<int>(blurs.steps[to_index(task.layer)].size()) - 1;
      for (int y = task.rows.begin - reach; y < task.rows.end + reach; ++y) {
        int read = y;
        while (read < 0 || read >= height) read = read < 0 ? -read : 2 * height - 2 - read;
        EXPECT_GE(read, rows_of[task.first_needed].begin);
        EXPECT_LT(read, rows_of[task.end_needed - 1].end);
      }
    }
  }
}

}  // namespace
}  // namespace weft::sift_fast
