// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <weft/core/suggest.hpp>

#include "common/cameras/format_values.hpp"
#include "common/yaml/yaml_file.hpp"

namespace weft::cameras {
namespace {

using yaml_files::FileMistake;

class LensReader : FormatValues {
 public:
  LensReader(const FormatValues& values, CameraBuilder& result)
      : FormatValues(values), result_(result) {}

  void read() {
    const Value* given = format_.coefficients.empty() ? nullptr : find(format_.coefficients);
    if (given != nullptr && values_.find(given->path + "/", "model|coefficients") != nullptr) {
      return read_named_lens(*given);
    }
    if (given != nullptr && given->kind == Value::Kind::scalar && !values_.is_xml()) {
      throw FileMistake(given->place, "'" + given->path + "' must be a list of numbers");
    }
    if (given != nullptr) {
      return result_.set_lens(given->place, model_name(), numbers(*list(format_.coefficients)));
    }
    const bool is_strict = &format_ == &own_format() && prefix_.empty();  // about all keys
    if (!is_strict && !format_.coefficients.empty()) refuse_other_names();
    if (format_.each) read_each(*format_.each);
  }

 private:
  /// The name of the lens model; brown where the file has none.
  std::string model_name() const {
    const Value* named = format_.model.empty() ? nullptr : find(format_.model);
    const Value* fisheye = find("fisheye_model");
    if (named != nullptr && named->kind == Value::Kind::scalar) return named->words.front().text;
    const bool is_fisheye = fisheye != nullptr && number(word(*fisheye), fisheye->path) != 0.0;
    return is_fisheye ? "fisheye" : "brown";
  }

  /// {model: brown, coefficients: [...]}
  void read_named_lens(const Value& lens) {
    const Value* model = values_.find(lens.path + "/", "model");
    const Value* values = values_.find(lens.path + "/", "coefficients");
    for (const auto& [name, value] :
         {std::pair{"model", model}, std::pair{"coefficients", values}}) {
      if (value == nullptr) {
        throw FileMistake(lens.place, "has no '" + std::string(name) +
                                          "'; 'distortion' has model and coefficients");
      }
    }
    if (model->kind != Value::Kind::scalar) {
      throw FileMistake(model->place, "'distortion.model' must be brown or fisheye");
    }
    if (values->kind != Value::Kind::list) {
      throw FileMistake(values->place, "'distortion.coefficients' must be a list of numbers");
    }
    result_.set_lens(model->place, model->words.front().text, numbers(*values));
  }

  /// k1, k2 and so on with a key each. Those that are not there are 0.
  void read_each(const std::string& before) {
    const std::string name = model_name();
    const auto lens = lens_named(name);
    const bool fisheye = lens && lens->model == Distortion::fisheye;
    std::vector<std::string> names{"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"};
    if (fisheye) names = {"k1", "k2", "k3", "k4"};
    if (format_.metashape && !fisheye) std::swap(names[2], names[3]);
    std::vector<double> values;
    const Value* first = nullptr;
    std::size_t last = 0;
    for (const std::string& each : names) {
      const Value* value = find(before + each);
      values.push_back(optional_number(before + each));
      if (first == nullptr) first = value;
      if (values.back() != 0.0) last = values.size();
    }
    if (first == nullptr) return;
    // The others' k4 is a coefficient of r^8, ours of a denominator.
    const bool even = &format_ != &own_format();
    for (const std::string& each : fisheye ? std::vector<std::string>{"p1", "p2"}
                                   : even  ? std::vector<std::string>{"k4", "k5", "k6"}
                                           : std::vector<std::string>{}) {
      if (optional_number(before + each) == 0.0) continue;
      throw FileMistake(find(before + each)->place,
                        "'" + before + each +
                            "' means what Weft's lens models do not have: calibrate without it");
    }
    if (!fisheye && last <= 5) values.resize(5);
    result_.set_lens(first->place, name, std::move(values));
  }

  /// A lens under a name that is not known must not pass as none.
  void refuse_other_names() const {
    std::vector<std::string> known{"distortion_coefficients", "distortion"};
    for (const Value& value : values_.all()) {
      if (!value.path.starts_with(prefix_)) continue;
      const std::string key = value.path.substr(prefix_.size());
      if (key.empty() || key.find('/') != key.npos || value.kind == Value::Kind::null) continue;
      if (key == "distortion_model") continue;
      std::string lower = key;
      for (char& c : lower) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
      const bool lens = value.kind != Value::Kind::scalar &&
                        (lower.find("dist") != lower.npos || lower.find("coef") != lower.npos);
      if (!lens && nearest(key, known).empty()) continue;
      throw FileMistake(value.key_place, "'" + value.path + "' is not known" +
                                             did_you_mean(key, known, ": is it the distortion?"));
    }
  }

  CameraBuilder& result_;
};

}  // namespace

void read_lens(const FormatValues& values, CameraBuilder& camera) {
  LensReader(values, camera).read();
}

}  // namespace weft::cameras
