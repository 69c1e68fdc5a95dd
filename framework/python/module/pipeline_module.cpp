// SPDX-License-Identifier: Apache-2.0
// The module weft.programs._pipeline: weft::Pipeline as weft/programs/pipelines.py needs it.
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <unistd.h>

#include <array>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/data/owned.hpp>
#include <weft/embedding/lens.hpp>
#include <weft/embedding/pipeline.hpp>

#include "numpy_arrays.hpp"

namespace py = pybind11;

namespace weft::python {
namespace {

using Texts = std::vector<std::string>;

const char* name_of(Errc code) {
  constexpr std::array kNames{
      "no_result",    "invalid_value", "invalid_data",   "not_found", "io",        "syntax",
      "incompatible", "unsupported",   "plugin_failure", "cancelled", "no_memory", "end"};
  const auto number = static_cast<std::int32_t>(code) - 1;
  return number >= 0 && to_index(number) < kNames.size() ? kNames[to_index(number)] : "unknown";
}

/// Raises it as weft.Error.
[[noreturn]] void raise(const Error& error) {
  const py::object type = py::module_::import("weft.programs.errors").attr("Error");
  const auto text = [](const std::string& bytes) {
    return py::reinterpret_steal<py::str>(
        PyUnicode_DecodeUTF8(bytes.data(), static_cast<Py_ssize_t>(bytes.size()), "replace"));
  };
  const py::object raised = type(text(error.message), text(error.where), name_of(error.code));
  PyErr_SetObject(type.ptr(), raised.ptr());
  throw py::error_already_set();
}

py::dict dict_of(const ProcessedFrame& frame) {
  py::list stages;
  for (const ProcessedFrame::Stage& stage : frame.stages) {
    stages.append(py::make_tuple(stage.name, stage.status, stage.reason, stage.ms));
  }
  py::dict result;
  result["index"] = frame.frame;
  result["state"] = to_string(frame.state());
  result["confidence"] = frame.confidence();
  result["failed"] = frame.failed;
  result["stages"] = stages;
  result["warnings"] = frame.warnings;
  result["report_json"] = frame.report;
  if (frame.shape) {
    result["age_frames"] = frame.shape->age_frames;
    result["vertices_m"] = numpy_of(frame.shape->vertices_m);
    result["source"] = numpy_of(frame.shape->source);
    result["covariance_m2"] = numpy_of(frame.shape->covariance_m2);
    result["diagnostics"] = named_of(frame.shape->diag);
  }
  return result;
}

using Pixels = py::array_t<std::uint8_t, 0>;
template <class T>
using Numbers = py::array_t<T, py::array::c_style>;
/// Positions in the template and in the image, and covariances.
using MatchArrays = std::tuple<Numbers<double>, Numbers<double>, std::optional<Numbers<double>>>;
/// Vertices, positions and radii.
using PointArrays = std::tuple<Numbers<std::int32_t>, Numbers<double>, Numbers<double>>;

template <class T, int kFlags>
Array<T> borrowed(const py::array_t<T, kFlags>& array) {
  typename Array<T>::Shape shape{};
  for (py::ssize_t axis = 0; axis < array.ndim(); ++axis) {
    shape[to_index(axis)] = array.shape(axis);
  }
  const auto size = static_cast<std::int64_t>(sizeof(T));
  const std::int64_t stride = array.ndim() > 0 ? array.strides(0) / size : 1;
  return Array<T>::borrow(array.data(), static_cast<int>(array.ndim()), shape, stride);
}

/// Rows of `pixels` may have gaps between them, the elements of a row may not.
Image image_of(const Pixels& pixels) {
  if (pixels.ndim() > WEFT_MAX_DIMENSIONS) {
    raise(
        {Errc::invalid_data, "has too many axes; give [H,W] grey levels or [H,W,3] BGR", "image"});
  }
  Image image;
  image.pixels = borrowed(pixels);
  return image;
}

using CameraNumbers = std::tuple<double, double, double, double, std::int64_t, std::int64_t>;

Camera camera_of(const CameraNumbers& numbers) {
  const auto& [fx, fy, cx, cy, width_px, height_px] = numbers;
  return {fx, fy, cx, cy, width_px, height_px};
}

std::unique_ptr<Lens> make_lens(const CameraNumbers& camera, bool is_fisheye,
                                std::vector<double> coefficients) {
  const auto model = is_fisheye ? Lens::Model::fisheye : Lens::Model::brown;
  auto lens = Lens::make(camera_of(camera), model, std::move(coefficients));
  if (!lens) raise(lens.error());
  return std::make_unique<Lens>(*std::move(lens));
}

py::object undistorted(const Lens& lens, const Pixels& pixels) {
  const auto ideal = lens.undistorted(image_of(pixels));
  if (!ideal) raise(ideal.error());
  return numpy_of(ideal->pixels);
}

py::object ideal_px(const Lens& lens, const Numbers<double>& seen_px) {
  const auto ideal = lens.ideal_px(borrowed(seen_px));
  if (!ideal) raise(ideal.error());
  return numpy_of(*ideal);
}

/// Other threads of Python go on while it works; a second one that comes meanwhile is refused, for
/// the order of the images would be left to chance.
class OpenedPipeline {
 public:
  OpenedPipeline(const std::string& file, const Camera& camera, const PipelineOptions& options) {
    auto loaded = [&] {
      const py::gil_scoped_release others_go_on;
      return Pipeline::load(file, camera, options);
    }();
    if (!loaded) raise(loaded.error());
    pipeline_.emplace(*std::move(loaded));
  }
  ~OpenedPipeline() { close(); }
  OpenedPipeline(const OpenedPipeline&) = delete;
  OpenedPipeline& operator=(const OpenedPipeline&) = delete;

  /// Components in Python end in it, in threads that want the lock of the interpreter. In the child
  /// of a fork nothing can be ended, and the mutex may be one that a thread of the parent has.
  void close() {
    if (getpid() != opener_) return;
    const py::gil_scoped_release others_go_on;
    const std::lock_guard alone(mutex_);
    pipeline_.reset();
  }

  py::dict templ() const {
    const Template templ = owned_record(pipeline_->templ());
    py::dict arrays;
    arrays["vertices_m"] = numpy_of(templ.vertices_m);
    arrays["faces"] = numpy_of(templ.faces);
    arrays["flat_px"] = numpy_of(templ.flat_px);
    arrays["m_per_px"] = numpy_of(templ.m_per_px);
    arrays["texture"] = numpy_of(templ.texture);
    arrays["mask"] = numpy_of(templ.mask);
    return arrays;
  }

  /// Each input may be None. Without `lens`, images and matches come from the ideal camera.
  py::dict process(const std::optional<Pixels>& pixels, double t_s,
                   const std::optional<MatchArrays>& matches,
                   const std::optional<PointArrays>& known, const Lens* lens) {
    FrameInputs inputs;
    if (pixels) inputs.image = image_of(*pixels);
    if (matches) {
      const auto& [template_px, image_px, covariance_px2] = *matches;
      inputs.correspondences =
          matches_between(borrowed(template_px), borrowed(image_px),
                          covariance_px2 ? borrowed(*covariance_px2) : Array<double>());
    }
    if (known) {
      const auto& [vertex, points_m, radius_m] = *known;
      inputs.known_points = vertices_at(borrowed(vertex), borrowed(points_m));
      inputs.known_points->radius_m = borrowed(radius_m);
    }
    const std::unique_lock alone(mutex_, std::try_to_lock);
    if (!alone) {
      raise({Errc::unsupported,
             "another thread's image is being processed; take turns, or open a pipeline for each",
             "pipeline"});
    }
    if (!pipeline_) raise({Errc::unsupported, "is closed; open it again", "pipeline"});
    auto frame = [&] {
      const py::gil_scoped_release others_go_on;
      return processed(std::move(inputs), t_s, lens);
    }();
    if (!frame) raise(frame.error());
    return dict_of(*frame);
  }

 private:
  Result<ProcessedFrame> processed(FrameInputs inputs, double t_s, const Lens* lens) {
    if (lens != nullptr && inputs.image) {
      auto ideal = lens->undistorted(*inputs.image);
      if (!ideal) return ideal.error();
      inputs.image = *std::move(ideal);
    }
    if (lens != nullptr && inputs.correspondences) {
      auto ideal = lens->ideal_px(inputs.correspondences->image_px);
      if (!ideal) return Error{ideal.error().code, ideal.error().message, "matches"};
      inputs.correspondences->image_px = *std::move(ideal);
    }
    return pipeline_->process(inputs, t_s);
  }

  std::mutex mutex_;
  std::optional<Pipeline> pipeline_;
  pid_t opener_ = getpid();
};

std::unique_ptr<OpenedPipeline> open_pipeline(const std::string& file, const CameraNumbers& camera,
                                              Texts settings, Texts plugin_path, Texts inputs,
                                              std::string worker) {
  return std::make_unique<OpenedPipeline>(
      file, camera_of(camera),
      PipelineOptions{std::move(settings), std::move(plugin_path), std::move(inputs),
                      std::move(worker)});
}

}  // namespace
}  // namespace weft::python

PYBIND11_MODULE(_pipeline, module) {
  using weft::python::OpenedPipeline;
  module.doc() = "What weft.Pipeline is made of; see there.";
  using weft::Lens;
  py::class_<Lens>(module, "Lens")
      .def(py::init(&weft::python::make_lens))
      .def("undistorted", &weft::python::undistorted)
      .def("ideal_px", &weft::python::ideal_px);
  py::class_<OpenedPipeline>(module, "OpenedPipeline")
      .def(py::init(&weft::python::open_pipeline))
      .def("template", &OpenedPipeline::templ)
      .def("process", &OpenedPipeline::process)
      .def("close", &OpenedPipeline::close);
}
