// SPDX-License-Identifier: Apache-2.0
#include "lab/metrics/forms/json.hpp"

#include <type_traits>
#include <weft/core/version.hpp>
#include <weft/core/whole_file.hpp>

#include "lab/metrics/forms/former_words.hpp"
#include "lab/metrics/forms/metrics_report.hpp"
#include "lab/metrics/runs/json_file.hpp"

namespace weft::lab {
namespace {

using nlohmann::json;
using nlohmann::ordered_json;

class JsonWriter {
 public:
  explicit JsonWriter(ordered_json& object) : object_(object) {}

  template <class Member>
  void operator()(const MetricField& field, const Member& member) {
    object_[field.name] = value_of(field, member);
  }

  template <class Value>
  void derived(const MetricField& field, const Value& value) {
    (*this)(field, value);
  }
  template <class Value>
  void derived(const MetricField& field, const std::optional<Value>& value) {
    if (value) (*this)(field, *value);
  }

  template <class Members>
  void object(const MetricField& field, bool there, Members&& members) {
    if (!there) return;
    ordered_json object;
    JsonWriter writer(object);
    members(writer);
    object_[field.name] = std::move(object);
  }

  template <class Members>
  void when(bool there, Members&& members) {
    if (there) members(*this);
  }

  template <class Metrics>
  void optional(const std::optional<Metrics>& metrics) {
    if (metrics) Metrics::fields(*metrics, *this);
  }

  template <class Metrics>
  void keyed(const MetricField& field, const std::vector<std::pair<std::string, Metrics>>& pairs) {
    for (const auto& [stage, metrics] : pairs) {
      object_[field.name][stage] = value_of(field, metrics);
    }
  }

 private:
  template <class Member>
  static ordered_json value_of(const MetricField& field, const Member& member) {
    if constexpr (MetricStruct<const Member>) {
      ordered_json object;
      JsonWriter writer(object);
      Member::fields(member, writer);
      return object;
    } else if constexpr (std::is_enum_v<Member>) {
      return to_string(member);
    } else if constexpr (std::is_floating_point_v<Member>) {
      return field.factor * member;
    } else if constexpr (std::is_same_v<Member, std::string>) {
      return field.or_null && member.empty() ? ordered_json(nullptr) : ordered_json(member);
    } else if constexpr (std::is_integral_v<Member>) {
      return member;
    } else {
      ordered_json list = ordered_json::array();
      for (const auto& each : member) list.push_back(value_of(field, each));
      return list;
    }
  }

  ordered_json& object_;
};

/// Throws what the library throws where a member has another type, or the object is none.
class JsonReader {
 public:
  using Object = json::object_t;

  explicit JsonReader(const json& object) : JsonReader(object.get_ref<const Object&>()) {}
  explicit JsonReader(const Object& object) : object_(object) {}

  /// True if any member was present.
  bool found() const { return found_; }

  template <class Member>
  void operator()(const MetricField& field, Member& member) {
    const auto place = place_of(field);
    if (place == object_.end()) return;
    found_ = true;
    read(field, place->second, member);
  }

  template <class Value>
  void derived(const MetricField& /*field*/, const Value& /*value*/) {}

  template <class Members>
  void object(const MetricField& field, bool& there, Members&& members) {
    const auto place = place_of(field);
    there = place != object_.end();
    if (!there) return;
    JsonReader reader(place->second);
    members(reader);
  }

  template <class Members>
  void when(bool /*there*/, Members&& members) {
    members(*this);
  }

  template <class Metrics>
  void optional(std::optional<Metrics>& metrics) {
    Metrics read;
    JsonReader reader(object_);
    Metrics::fields(read, reader);
    if (reader.found()) metrics = std::move(read);
  }

  template <class Metrics>
  void keyed(const MetricField& field, std::vector<std::pair<std::string, Metrics>>& pairs) {
    const auto place = place_of(field);
    if (place == object_.end()) return;
    for (const auto& [stage, object] : place->second.get_ref<const Object&>()) {
      JsonReader reader(object);
      Metrics::fields(pairs.emplace_back(stage, Metrics{}).second, reader);
    }
  }

 private:
  /// Files of earlier versions have former names.
  Object::const_iterator place_of(const MetricField& field) const {
    const auto place = object_.find(field.name);
    return place != object_.end() ? place : object_.find(std::string(former_word(field.name)));
  }

  template <class Member>
  static void read(const MetricField& field, const json& value, Member& member) {
    if constexpr (MetricStruct<Member>) {
      JsonReader reader(value);
      Member::fields(member, reader);
    } else if constexpr (std::is_enum_v<Member>) {
      member = enumerator(value.get<std::string>(), member);
    } else if constexpr (std::is_floating_point_v<Member>) {
      member = value.is_null() ? kUnknown : value.get<double>() / field.factor;
    } else if constexpr (std::is_same_v<Member, std::string>) {
      member = field.or_null && value.is_null() ? std::string() : value.get<std::string>();
    } else if constexpr (std::is_integral_v<Member>) {
      member = value.get<Member>();
    } else {
      read_list(field, value, member);
    }
  }

  template <class Member>
  static void read_list(const MetricField& field, const json& value, std::vector<Member>& list) {
    list.resize(value.size());
    for (std::size_t i = 0; i < list.size(); ++i) read(field, value.at(i), list[i]);
  }
  template <class Member, std::size_t kCount>
  static void read_list(const MetricField& field, const json& value,
                        std::array<Member, kCount>& list) {
    for (std::size_t i = 0; i < kCount; ++i) read(field, value.at(i), list[i]);
  }

  /// The enumerator of that name; enumerators are numbered from 0.
  template <class Enumeration>
  static Enumeration enumerator(const std::string& name, Enumeration otherwise) {
    const std::string_view current = current_word(name);
    for (int i = 0; i <= static_cast<int>(last(otherwise)); ++i) {
      if (current == to_string(static_cast<Enumeration>(i))) return static_cast<Enumeration>(i);
    }
    return otherwise;
  }
  static constexpr ShapeState last(ShapeState /*type*/) { return ShapeState::lost; }
  static constexpr FrameOutcome last(FrameOutcome /*type*/) { return FrameOutcome::invalid; }
  static constexpr Alignment last(Alignment /*type*/) { return Alignment::rigid; }

  const Object& object_;
  bool found_ = false;
};

}  // namespace

ordered_json json_of(const RunMetrics& metrics) {
  ordered_json object{{"schema", "weft-metrics/1"}, {"weft", kVersion}};
  JsonWriter writer(object);
  RunMetrics::fields(metrics, writer);
  return object;
}

Result<RunMetrics> metrics_of(const json& object) {
  RunMetrics metrics;
  try {
    JsonReader reader(object);
    RunMetrics::fields(metrics, reader);
  } catch (const json::exception& mistake) {
    return Error{Errc::invalid_data, "metrics: " + reason_of(mistake)};
  }
  return metrics;
}

std::string to_json(const RunMetrics& metrics) {
  return json_of(metrics).dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

std::string metrics_file_name(Alignment alignment) {
  if (alignment == Alignment::none) return "metrics.json";
  return std::string("metrics_") + to_string(alignment) + ".json";
}

Result<void> write_json(const RunMetrics& metrics, const std::string& file) {
  return write_whole(to_json(metrics), file);
}

}  // namespace weft::lab
