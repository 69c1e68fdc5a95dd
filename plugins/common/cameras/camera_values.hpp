// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <yaml-cpp/yaml.h>

#include <string>
#include <string_view>
#include <vector>

namespace weft::cameras {

/// A number or name of a camera file, and its place.
struct Word {
  std::string text;
  YAML::Mark place;
  bool is_scalar = true;  ///< false of a list or map where a number is due
};

/// A value of a camera file, whatever its syntax. A list of rows of equal length is the list of
/// their numbers.
struct Value {
  enum class Kind { null, scalar, list, map };
  std::string path;  ///< "cam0/intrinsics": the keys that lead to it
  Kind kind = Kind::null;
  YAML::Mark place, key_place;
  std::vector<Word> words;
};

/// All values of a camera file, in their order.
class CameraValues {
 public:
  /// Throws FileMistake where a key is given twice, or nothing is a map.
  static CameraValues of_yaml(const YAML::Node& root);
  /// The elements of an XML file by their names; the root element has none. Throws FileMistake.
  static CameraValues of_xml(const std::string& text);
  /// The first camera of COLMAP's cameras.txt as model, width, height and params; nothing of any
  /// other text.
  static CameraValues of_colmap(const std::string& text);

  bool empty() const { return values_.empty(); }
  bool is_xml() const { return !xml_root_.empty(); }
  const std::string& xml_root() const { return xml_root_; }  ///< its name
  const std::vector<Value>& all() const { return values_; }
  const YAML::Mark& place() const { return place_; }

  /// The first of these paths, separated by '|', that has a value; null where none has.
  const Value* find(std::string_view prefix, std::string_view paths) const;

 private:
  friend class YamlValues;
  friend class XmlValues;
  std::vector<Value> values_;
  YAML::Mark place_;
  std::string xml_root_;
};

}  // namespace weft::cameras
