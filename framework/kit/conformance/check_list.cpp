// SPDX-License-Identifier: Apache-2.0
#include "kit/conformance/check_list.hpp"

#include <algorithm>
#include <cctype>

namespace weft::conformance {
namespace {

constexpr bool kBrief = true;

std::vector<CheckInfo> of_files_and_tables() {
  return {
      {"load/symbol", "The library exports only `weft_library`.", kBrief},
      {"load/static_tls",
       "It has no thread-local variables that need room at the start of the program.", kBrief},
      {"load/time",
       "Loading it takes less than 300 ms, the second time, without the processor use of other "
       "processes; above 100 ms it is noted."},
      {"load/floating_point",
       "Loading it leaves rounding and the treatment of subnormal numbers as they were.", kBrief},
      {"load/binds_now", "It can be loaded with all its symbols bound.", kBrief},
      {"load/silent", "Loading it prints nothing.", kBrief},
      {"load/threads", "Loading it starts no thread.", kBrief},
      {"load/layout",
       "Magic number, version, sizes, reserved fields and texts of its table are legal.", kBrief},
      {"load/processor",
       "It names the processor features that its manifest names, and this processor has them.",
       kBrief},
      {"load/manifest", "The manifest equals the library's own description.", kBrief},
      {"load/strip", "Stripped, it can be loaded and is bound to its manifest."},
      {"load/opens_nothing", "Describing its components opens no file.", kBrief},
      {"table/unknown_extension", "An unknown extension is null.", kBrief},
      {"table/extensions_stable",
       "An extension is the same table each time, begins with its size, and is in the manifest.",
       kBrief},
      {"table/methods", "Its methods are some of those of its role.", kBrief},
      {"table/unknown_method", "A method that there is not is refused."},
      {"table/older_host", "Nothing is read behind the end of the structs of version 1.0."},
      {"table/newer_host",
       "Structs that are longer than the present ones, with unknown contents, change no answer."},
      {"parameters/defaults", "Defaults are legal values.", kBrief},
      {"parameters/beyond",
       "A value beyond a range, NaN, or none of the choices is refused by the component itself, "
       "with `weft_error.subject`.",
       kBrief},
      {"parameters/wrong_type", "So is a value of another type.", kBrief},
      {"parameters/unknown", "A value of an unknown name is ignored, or refused by that name.",
       kBrief},
      {"parameters/ends",
       "Both ends of each range, each flag and each choice give a legal answer."},
      {"parameters/pairs",
       "So do 200 random pairs of values, or as many as fit into 20 s of CPU "
       "time."},
      {"parameters/live", "A parameter set between two frames gives what a new instance gives."},
  };
}

std::vector<CheckInfo> of_contract() {
  std::vector<CheckInfo> all = {
      {"its_parameters", "The component can be had with its parameters."},
      {"its_manifest", "It has an id, a version and a summary, and announces an output."},
      {"created_and_prepared", "It can be created and prepared."},
      {"created_again", "It can be created and prepared a second time."},
      {"with_a_usual_input", "A usual input is answered by legal outputs."},
      {"with_another_frame", "So is another one."},
      {"without_*",
       "So is one that lacks an optional input, named in the place of `*`, or refused with a "
       "reason."},
      {"with_what_it_needs_alone", "So is one that lacks all optional inputs."},
      {"with_a_colour_image", "A colour image is answered."},
      {"with_an_empty_image",
       "An image of 0 pixels is answered, or refused with a reason; never by ok and nothing. So "
       "are the next."},
      {"with_an_image_of_one_pixel", "An image of one pixel."},
      {"with_an_image_without_texture", "A grey image."},
      {"with_an_empty_region", "A region without a pixel."},
      {"with_a_region_of_another_size", "A region of another size than the image."},
      {"with_bits_for_descriptors", "Binary descriptors."},
      {"with_descriptors_of_two_kinds", "Binary descriptors in the image, others on the template."},
      {"with_0_keypoints_in_the_image", "No keypoint in the image."},
      {"with_0_keypoints_on_the_template", "No keypoint on the template."},
      {"with_one_descriptor_for_all_keypoints", "Indistinguishable keypoints."},
      {"with_0_matches",
       "No match; components that make shapes, warps or masks report more than ok."},
      {"with_1_match", "One match."},
      {"with_2_matches", "Two matches."},
      {"with_3_matches_on_a_line", "Three matches on a line."},
      {"with_all_matches_the_same", "Forty times the same match."},
      {"with_matches_that_were_rejected_before", "What was rejected before stays so."},
      {"with_no_kept_match", "All matches rejected."},
      {"with_no_match_on_the_mesh", "No match that has a face."},
      {"with_0_sightlines", "No sightline."},
      {"with_1_sightline", "One sightline."},
      {"with_3_sightlines_on_a_line", "Three sightlines on a line."},
      {"with_all_sightlines_the_same", "Forty times the same sightline."},
      {"with_sightlines_that_count_nothing", "Sightlines of weight 0."},
      {"with_weights_of_0", "Weights of 0."},
      {"with_a_warp_that_is_valid_nowhere", "A warp that is valid nowhere."},
      {"with_nothing_visible", "Every vertex hidden."},
      {"after_other_calls", "The same inputs are answered by the same bytes after other calls."},
      {"when_it_is_told_to_stop",
       "It stops within 10 s or ends its work, and answers as before when it is called again."},
      {"evaluated_from_its_record_alone", "A warp is evaluated from its record alone."},
      {"evaluated_at_no_point", "A warp is evaluated at no point."},
      {"derivatives_of_order_1", "Its first derivatives are those of its values."},
      {"derivatives_of_order_2", "Its second derivatives are those of its first."},
      {"opened", "A source opens, and its camera is legal."},
      {"counted", "It reports its number of frames."},
      {"the_first_frame", "Its first frame is legal."},
      {"the_last_frame", "So is its last one."},
      {"read_in_another_order", "Frames do not depend on the order in which they are read."},
      {"built", "A template is built, and is legal."},
      {"built_again", "It is the same the second time."},
      {"two_frames", "A sink takes two frames and leaves no empty file."},
      {"two_frames_again", "It writes the same files the second time."},
      {"no_frame", "It can be opened and finished without a frame."},
  };
  for (CheckInfo& info : all) {
    info.name = "contract/" + info.name;
    info.brief = true;
  }
  return all;
}

std::vector<CheckInfo> of_inputs_and_memory() {
  return {
      {"contract/padded_inputs", "Inputs with padding between rows are answered as those without."},
      {"contract/backward_inputs", "So are inputs whose rows run backwards."},
      {"contract/aligned_inputs", "So are inputs that are aligned to their elements alone."},
      {"contract/unknown_arrays", "So are records with an unknown array."},
      {"contract/undeclared_slots", "So are calls with an unknown input."},
      {"contract/dirty_memory", "Former contents of the memory that `alloc` gives do not matter."},
      {"contract/output_bounds", "Nothing is written behind what `alloc` gives."},
      {"contract/no_memory", "An `alloc` that gives null is answered by an error with that code."},
      {"contract/error_text", "Texts of errors are UTF-8, end with NUL, and are not empty."},
      {"contract/nan_inputs",
       "Inputs that mark what is missing with NaN are answered, or refused with a reason."},
  };
}

std::vector<CheckInfo> of_geometry() {
  return {
      {"geometry/geometry",
       "For components whose answers follow from places; otherwise it does not apply."},
      {"geometry/matches_permuted", "Matches in another order: the same answer in that order."},
      {"geometry/matches_given_twice", "Matches given twice: both are judged alike."},
      {"geometry/image_shifted", "The image and its camera shifted: the same shape and mask."},
      {"geometry/image_scaled", "Both scaled, with parameters in px: the same."},
      {"geometry/image_rolled", "Both rolled by a quarter turn: the shape rolled."},
      {"geometry/image_mirrored", "Image and template mirrored: the shape mirrored."},
      {"geometry/world_scaled", "Lengths doubled, with parameters in m: the shape doubled."},
      {"geometry/vertices_renumbered", "Vertices and faces in another order: the same shape."},
      {"geometry/a_scene_that_is_moved", "The requirements on it under these moves."},
      {"geometry/exact_matches", "Matches without noise and mismatches lead to the truth."},
      {"geometry/error_grows_with_noise", "Noise leads away from it."},
      {"geometry/identity_warp", "The warp of an image to itself moves nothing."},
  };
}

std::vector<CheckInfo> of_calls_and_limits() {
  return {
      {"calls/exit",
       "A program that has used it ends with `exit`: without a crash, a text, or another exit "
       "code."},
      {"calls/repeated",
       "A frame that is requested twice is answered by the same bytes (by numbers within 0.001 of "
       "the largest where `determinism` is `tolerance`, here and below)."},
      {"calls/created_anew", "So is one of an instance that is made after another one."},
      {"calls/shuffled_frames", "The order of frames does not matter to stages and sources."},
      {"calls/any_thread", "The thread that creates, calls or destroys does not matter."},
      {"calls/threads", "How many threads a call may use does not matter."},
      {"calls/at_once",
       "Eight instances, created and called at once by eight threads, answer as a single one."},
      {"calls/prepared_twice",
       "An instance that is prepared twice answers as one that is prepared once."},
      {"calls/unprepared", "An instance can be destroyed without being prepared."},
      {"calls/structs", "The structs of a call are only read, and not used once it has returned."},
      {"calls/log",
       "Texts for the log are lines of UTF-8 of at most 4096 bytes, and at most 100 in a call."},
      {"calls/invocations", "It invokes only components that it was given."},
      {"calls/sanitized",
       "Two instances at once have no data race: only a build with ThreadSanitizer detects it, so "
       "never here."},
      {"calls/state", "State can be saved and put back: nothing of version 1.0, so never here."},
      {"limits/locale", "The locale stays as it was."},
      {"limits/floating_point",
       "So do rounding and the treatment of subnormal numbers, before the host sets them back,"},
      {"limits/signals", "handlers and masks of signals,"},
      {"limits/working_directory", "the working directory,"},
      {"limits/umask", "the mask of permissions,"},
      {"limits/environment", "the environment,"},
      {"limits/process", "resource limits, timers, CPU affinity, priority and terminate handler,"},
      {"limits/opencv_threads", "and the number of OpenCV's threads."},
      {"limits/silent", "It prints nothing to stdout, which belongs to the program."},
      {"limits/generator", "The C library's random generator is not drawn from."},
      {"limits/seed",
       "The seed matters only to a component that declares `random`, or contains one that does."},
      {"limits/descriptors", "Instances leave no file open."},
      {"limits/threads", "Once destroyed, instances leave no thread behind."},
      {"limits/processes", "Nor do they leave a process behind."},
      {"limits/isolated", "In a separate process it gives the same bytes."},
      {"limits/memory",
       "10,000 calls, or as many as fit into 2 s of CPU time and at least 10, grow the process by "
       "less than 1 "
       "MiB. Each grows the heap by less than 128 bytes, the least of three times."},
      {"limits/large",
       "An image of 3840 x 2160 or 100,000 matches are answered in 16 GiB. After 30 s of CPU time, "
       "or 120 s, it is cancelled, and stops within 10 s, without the processor use of other "
       "processes."},
      {"limits/cancelled",
       "Cancelled 20 ms into such a call, it computes and waits for less than 2 s; above 50 ms it "
       "is noted."},
      {"limits/clock",
       "The clock does not matter: a call of it cannot be observed, so never here."},
  };
}

std::vector<CheckInfo> made() {
  std::vector<CheckInfo> all;
  for (const auto& part : {of_files_and_tables(), of_contract(), of_inputs_and_memory(),
                           of_geometry(), of_calls_and_limits()}) {
    all.insert(all.end(), part.begin(), part.end());
  }
  return all;
}

}  // namespace

const std::vector<CheckInfo>& all_checks() {
  static const std::vector<CheckInfo> all = made();
  return all;
}

const CheckInfo* find_check(std::string_view name) {
  const CheckInfo* found = nullptr;
  for (const CheckInfo& info : all_checks()) {
    const std::string_view known = info.name;
    if (known == name) return &info;
    const bool is_like =
        known.ends_with("*") && name.starts_with(known.substr(0, known.size() - 1));
    if (is_like) found = &info;
  }
  return found;
}

std::string as_name(std::string_view words) {
  std::string name(words);
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
}

}  // namespace weft::conformance
