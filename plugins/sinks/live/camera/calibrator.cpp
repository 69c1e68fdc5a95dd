// SPDX-License-Identifier: Apache-2.0
#include "camera/calibrator.hpp"

#include <atomic>
#include <charconv>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <thread>
#include <utility>
#include <weft/core/index.hpp>
#include <weft/core/quote.hpp>
#include <weft/core/whole_file.hpp>

#include "lab/calibration/calibrate.hpp"
#include "lab/calibration/camera_text.hpp"
#include "lab/calibration/view_collection.hpp"

namespace weft::live {
namespace {

namespace cal = calibration;
using nlohmann::json;

constexpr std::size_t kEnoughViews = 20;
/// Between searches for the board: they must leave the processor to the run.
constexpr std::chrono::milliseconds kSearchEvery{100};

Result<cal::Board> board_of(std::string_view text) {
  const cal::Board usual;
  const auto given = json::parse(text, nullptr, false);
  if (!given.is_object()) return Error{Errc::syntax, "begin needs a JSON object with the board"};
  try {
    return cal::parse_board(given.value("squares", "7x5"), given.value("square_m", usual.square_m),
                            given.value("pattern", "charuco"),
                            given.value("dictionary", usual.dictionary),
                            given.value("marker_share", usual.marker_share));
  } catch (const json::exception&) {
    return Error{Errc::invalid_value, "a member of the board has the wrong type"};
  }
}

cv::Mat grey_of(const Array<std::uint8_t>& pixels) {
  const auto rows = static_cast<int>(pixels.dim(0)), columns = static_cast<int>(pixels.dim(1));
  const bool is_colour = pixels.ndim() == 3;
  // OpenCV has no view of constant pixels.
  const cv::Mat view(rows, columns, is_colour ? CV_8UC3 : CV_8UC1,
                     const_cast<std::uint8_t*>(pixels.data()), to_index(pixels.row_stride()));
  cv::Mat grey;
  if (is_colour) {
    cv::cvtColor(view, grey, cv::COLOR_BGR2GRAY);
  } else {
    view.copyTo(grey);
  }
  return grey;
}

json places_of(const cal::View& view) {
  json places = json::array();
  for (Eigen::Index i = 0; i < view.image_px.rows(); ++i) {
    places.push_back(view.image_px(i, 0));
    places.push_back(view.image_px(i, 1));
  }
  return places;
}

json state_of(const cal::ViewCollection& collection) {
  const auto coverage = cal::coverage_of(collection.views(), collection.size());
  json cells = json::array();
  for (Eigen::Index row = 0; row < coverage.corners.rows(); ++row) {
    for (Eigen::Index column = 0; column < coverage.corners.cols(); ++column) {
      cells.push_back(coverage.corners(row, column));
    }
  }
  std::vector<std::string> missing = coverage.missing();
  if (missing.empty() && collection.views().size() < kEnoughViews) {
    missing.emplace_back("more views that are unlike these");
  }
  return {{"views", collection.views().size()},
          {"enough", kEnoughViews},
          {"cells", std::move(cells)},
          {"missing", std::move(missing)}};
}

class BoardCalibrator final : public Calibrator {
 public:
  BoardCalibrator(std::string file, std::function<void(std::string)> report)
      : file_(std::move(file)), report_(std::move(report)), thread_([this] { work(); }) {}
  ~BoardCalibrator() override {
    {
      const std::lock_guard lock(mutex_);
      is_over_ = true;
    }
    changed_.notify_all();
    thread_.join();
  }
  BoardCalibrator(const BoardCalibrator&) = delete;
  BoardCalibrator& operator=(const BoardCalibrator&) = delete;

  std::string ask(std::string_view request) override {
    constexpr std::string_view kBegin = "begin ", kEnd = "end ";
    if (request == "stop") return order({Order::Kind::stop, {}, 0}, true);
    if (request.starts_with(kBegin)) {
      const auto board = board_of(request.substr(kBegin.size()));
      if (!board) return board.error().message;
      return order({Order::Kind::begin, *board, 0}, true);
    }
    if (request.starts_with(kEnd)) {
      const std::string_view number = request.substr(kEnd.size());
      int coefficients = -1;
      std::from_chars(number.data(), number.data() + number.size(), coefficients);
      for (const int known : {0, 4, 5, 8}) {
        if (coefficients == known) return order({Order::Kind::end, {}, coefficients}, false);
      }
      return "the lens has 0, 4, 5 or 8 coefficients, not " + quote(number);
    }
    return "calibrate accepts begin BOARD, end COEFFICIENTS and stop";
  }

  bool wants_frame() const override { return wants_frame_; }

  void put_frame(const Array<std::uint8_t>& pixels, std::uint64_t frame) override {
    if (!pixels.present() || pixels.size() == 0) return;
    cal::Frame copy{"frame " + std::to_string(frame), grey_of(pixels)};
    {
      const std::lock_guard lock(mutex_);
      frame_ = {std::move(copy), frame};
      wants_frame_ = false;
    }
    changed_.notify_all();
  }

 private:
  struct Order {
    enum class Kind { begin, end, stop } kind;
    cal::Board board;
    int coefficients;
  };

  std::string order(Order order, bool is_always) {
    {
      const std::lock_guard lock(mutex_);
      if (!is_always && !is_collecting_) return "no calibration has begun";
      is_collecting_ = order.kind == Order::Kind::begin;
      order_ = std::move(order);
      wants_frame_ = false;
    }
    changed_.notify_all();
    return {};
  }

  void work() {
    std::unique_lock lock(mutex_);
    while (true) {
      changed_.wait(lock, [this] { return is_over_ || order_ || frame_; });
      if (is_over_) return;
      const auto order = std::exchange(order_, std::nullopt);
      const auto frame = std::exchange(frame_, std::nullopt);
      lock.unlock();
      if (order) take(*order);
      if (!order && frame && collection_) search(*frame);
      lock.lock();
      if (!collection_) continue;
      changed_.wait_for(lock, kSearchEvery, [this] { return is_over_ || order_; });
      wants_frame_ = is_collecting_ && !order_;
    }
  }

  void take(const Order& order) {
    if (order.kind == Order::Kind::stop) {
      collection_.reset();
      return say({{"state", "off"}});
    }
    if (order.kind == Order::Kind::begin) {
      collection_.emplace(order.board);
      json state = state_of(*collection_);
      state["state"] = "collecting";
      return say(std::move(state));
    }
    if (!collection_) return;
    json state = state_of(*collection_);
    state["state"] = "solving";
    say(state);
    finish(order.coefficients, std::move(state));
    collection_.reset();
  }

  void search(const std::pair<cal::Frame, std::uint64_t>& frame) {
    const auto kept = collection_->add_if_new(frame.first);
    if (!kept) return fail(kept.error().message);
    json state = state_of(*collection_);
    state["state"] = "collecting";
    state["frame"] = frame.second;
    state["kept"] = *kept;
    if (const auto& view = collection_->last()) {
      state["corners_px"] = places_of(*view);
    } else {
      state["reason"] = collection_->last_fault();
    }
    say(std::move(state));
  }

  void finish(int coefficients, json state) {
    const auto calibration =
        cal::calibrate(collection_->views(), collection_->size(), coefficients);
    if (!calibration) return fail(calibration.error().message, std::move(state));
    const std::string text = cal::camera_text(*calibration);
    state["state"] = "done";
    state["used"] = calibration->views.size();
    state["odd"] = calibration->odd;
    state["rms_px"] = calibration->solution.rms_px;
    state["fx"] = calibration->solution.fx;
    state["fx_deviation"] = calibration->solution.deviation[0];
    state["camera_file"] = text;
    if (!file_.empty()) {
      const auto written = write_whole(text, file_);
      state["path"] = written ? json(file_) : json();
      if (!written) state["reason"] = file_ + ": " + written.error().message;
    }
    say(std::move(state));
  }

  void fail(const std::string& reason, json state = json::object()) {
    state["state"] = "failed";
    state["reason"] = reason;
    say(std::move(state));
    collection_.reset();
    const std::lock_guard lock(mutex_);
    is_collecting_ = false;
  }

  void say(json state) const {
    report_(state.dump(-1, ' ', false, json::error_handler_t::replace));
  }

  std::string file_;
  std::function<void(std::string)> report_;
  std::optional<cal::ViewCollection> collection_;  ///< for the thread; null if none goes on

  std::atomic<bool> wants_frame_ = false;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<Order> order_;
  std::optional<std::pair<cal::Frame, std::uint64_t>> frame_;
  bool is_collecting_ = false, is_over_ = false;
  std::thread thread_;
};

}  // namespace

std::unique_ptr<Calibrator> make_calibrator(std::string file,
                                            std::function<void(std::string)> report) {
  return std::make_unique<BoardCalibrator>(std::move(file), std::move(report));
}

}  // namespace weft::live
