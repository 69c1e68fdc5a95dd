// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <weft/core/index.hpp>
#include <weft/core/inline_vector.hpp>
#include <weft/sdk/role.hpp>

namespace weft {

/// Input of a solver, also for parents of nested solvers.
struct SolverInput {
  Call call;
  Template templ{};
  Camera camera{};
  OptionalInput<Sightlines> sightlines{};
  OptionalInput<Correspondences> correspondences{};
  OptionalInput<Warp> warp{};  ///< evaluate with weft::evaluate()
  OptionalInput<Image> image{};
  OptionalInput<Visibility> visibility{};
  OptionalInput<KnownPoints> known_points{};
  OptionalInput<ObjectMask> object_mask{};
  OptionalInput<Shape> previous_shape{};  ///< may be `lost`: check its state

  template <class Self, class Visit>
  static void slots(Self& self, Visit&& visit) {
    visit("template", self.templ);
    visit("camera", self.camera);
    visit("sightlines", self.sightlines);
    visit("correspondences", self.correspondences);
    visit("warp", self.warp);
    visit("image", self.image);
    visit("visibility", self.visibility);
    visit("known_points", self.known_points);
    visit("object_mask", self.object_mask);
    visit("previous.shape", self.previous_shape);
  }
};

namespace detail {

/// The inputs of a call.
using Inputs = InlineVector<weft_record, 12>;

/// Answer of another component. It borrows host memory that lives until the caller's process()
/// returns.
struct Answer {
  std::span<const weft_record> outputs;  ///< [.] records of the outputs
  std::string degenerate_reason;         ///< empty unless the answer is degenerate

  /// The output of this type, if there is one.
  template <class RecordType>
  std::optional<Result<RecordType>> find() const {
    for (const weft_record& output : outputs) {
      if (std::string_view(output.type) == RecordType::kType)
        return read_record<RecordType>(output);
    }
    return std::nullopt;
  }
};

/// Calls `component` through the host for the frame of the call.
inline Result<Answer> ask(const Call& call, std::uint64_t component, int method,
                          std::span<const weft_record> inputs) {
  weft_invocation asked{};
  asked.struct_size = sizeof(weft_invocation);
  asked.method = method;
  asked.component = component;
  asked.inputs = inputs.data();
  asked.input_count = inputs.size();
  asked.frame = call.frame();
  weft_error error = kNoError;
  const std::int32_t status = call.raw().host->invoke(&call.raw(), &asked, &error);
  if (status != WEFT_OK && status != WEFT_DEGENERATE) {
    return Error{static_cast<Errc>(error.code), error.message, error.where, error.subject};
  }
  return Answer{{asked.outputs, to_index(asked.output_count)},
                status == WEFT_DEGENERATE ? error.message : ""};
}

/// The only output of a method.
template <class Output>
Result<Output> invoke(const Call& call, std::uint64_t component, int method,
                      std::span<const weft_record> inputs) {
  const auto answer = ask(call, component, method, inputs);
  if (!answer) return answer.error();
  auto typed = answer->template find<Output>();
  if (!typed) {
    return Error{Errc::plugin_failure, std::string("no ") + Output::kType + " was produced"};
  }
  if (*typed && !answer->degenerate_reason.empty()) {
    return degenerate(**std::move(typed), answer->degenerate_reason);
  }
  return *std::move(typed);
}

}  // namespace detail

/// Values and, up to `points.order`, derivatives of a warp, evaluated by its producer.
inline Result<WarpSamples> evaluate(const Call& call, const Warp& warp, const Points& points) {
  const RecordView<Warp> warp_view("warp", warp);
  const RecordView<Points> points_view("points", points);
  const weft_record inputs[] = {warp_view.raw(), points_view.raw()};
  return detail::invoke<WarpSamples>(call, warp.producer_handle, WEFT_WARP_EVALUATE, inputs);
}

/// A nested warp: `WarpComponent warp_{"warps/bbs"};` and, in the constructor, `p.component("warp",
/// warp_, "...")`.
struct WarpComponent : ComponentHandle {
  explicit WarpComponent(const char* default_component)
      : ComponentHandle{"warps", default_component} {}

  /// Fits the matches with kept = 1; uses `weights` if they are given.
  Result<Warp> fit(const Call& call, const Correspondences& correspondences, const Template& templ,
                   const Weights* weights = nullptr) const {
    const RecordView<Correspondences> matches("correspondences", correspondences);
    const RecordView<Template> template_view("template", templ);
    detail::Inputs inputs;
    inputs.push_back(matches.raw());
    inputs.push_back(template_view.raw());
    std::optional<RecordView<Weights>> weights_view;
    if (weights != nullptr) inputs.push_back(weights_view.emplace("weights", *weights).raw());
    return detail::invoke<Warp>(call, handle, WEFT_WARP_FIT, inputs);
  }
};

/// A nested solver, for example for an initial guess.
struct SolverComponent : ComponentHandle {
  explicit SolverComponent(const char* default_component)
      : ComponentHandle{"solvers", default_component} {}

  Result<Shape> solve(const SolverInput& in) const {
    detail::Inputs inputs;
    const RecordView<Template> templ("template", in.templ);
    const RecordView<Camera> camera("camera", in.camera);
    inputs.push_back(templ.raw());
    inputs.push_back(camera.raw());
    std::optional<RecordView<Sightlines>> sightlines;
    std::optional<RecordView<Correspondences>> correspondences;
    std::optional<RecordView<Warp>> warp;
    std::optional<RecordView<Image>> image;
    std::optional<RecordView<Visibility>> visibility;
    std::optional<RecordView<KnownPoints>> known_points;
    std::optional<RecordView<ObjectMask>> object_mask;
    std::optional<RecordView<Shape>> previous;
    const auto add = [&inputs](auto& view, const char* slot, const auto& typed) {
      if (typed) inputs.push_back(view.emplace(slot, *typed).raw());
    };
    add(sightlines, "sightlines", in.sightlines);
    add(correspondences, "correspondences", in.correspondences);
    add(warp, "warp", in.warp);
    add(image, "image", in.image);
    add(visibility, "visibility", in.visibility);
    add(known_points, "known_points", in.known_points);
    add(object_mask, "object_mask", in.object_mask);
    add(previous, "previous.shape", in.previous_shape);
    return detail::invoke<Shape>(in.call, handle, 0, inputs);
  }
};

}  // namespace weft
