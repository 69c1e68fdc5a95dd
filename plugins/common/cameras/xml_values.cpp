// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <boost/property_tree/ptree.hpp>
#include <boost/property_tree/xml_parser.hpp>
#include <sstream>

#include "common/cameras/camera_values.hpp"
#include "common/yaml/yaml_file.hpp"

namespace weft::cameras {

using boost::property_tree::ptree;
using yaml_files::FileMistake;

class XmlValues {
 public:
  explicit XmlValues(const std::string& text) : text_(text) {}

  CameraValues read() {
    check_depth();
    ptree tree;
    try {
      std::istringstream stream(text_);
      namespace xml = boost::property_tree::xml_parser;
      xml::read_xml(stream, tree, xml::no_comments | xml::trim_whitespace);
    } catch (const boost::property_tree::xml_parser_error& error) {
      YAML::Mark place = mark_at(0);
      place.line = std::max(static_cast<int>(error.line()) - 1, 0);
      throw FileMistake(place, "cannot be understood as XML from here on: " + error.message());
    }
    if (tree.size() != 1) throw FileMistake(mark_at(0), "must have one root element");
    values_.xml_root_ = tree.front().first;
    values_.place_ = place_of(values_.xml_root_);
    add_children("", tree.front().second);
    return std::move(values_);
  }

 private:
  /// The parser of Boost calls itself for each level.
  void check_depth() const {
    constexpr int kMostLevels = 32;
    int depth = 0;
    for (std::size_t at = text_.find('<'); at != text_.npos; at = text_.find('<', at + 1)) {
      const char next = at + 1 < text_.size() ? text_[at + 1] : '/';
      const std::size_t end = text_.find('>', at);
      if (next == '/') --depth;
      if (next == '/' || next == '!' || next == '?' || end == text_.npos) continue;
      if (text_[end - 1] != '/') ++depth;
      if (depth > kMostLevels)
        throw FileMistake(mark_at(at), "has too many elements inside another");
    }
  }

  YAML::Mark mark_at(std::size_t byte) const {
    YAML::Mark mark;
    const std::size_t start = byte == 0 ? 0 : text_.rfind('\n', byte - 1) + 1;  // npos + 1 is 0
    mark.pos = static_cast<int>(byte);
    mark.line = static_cast<int>(
        std::count(text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(start), '\n'));
    mark.column = static_cast<int>(byte - start);
    return mark;
  }

  /// Place of the next element of this name behind the last one.
  YAML::Mark place_of(const std::string& name) {
    for (std::size_t at = text_.find("<" + name, at_); at != text_.npos;
         at = text_.find("<" + name, at + 1)) {
      const std::size_t end = at + 1 + name.size();
      if (end < text_.size() && std::string(" \t\r\n/>").find(text_[end]) == std::string::npos) {
        continue;
      }
      at_ = end;
      return mark_at(at);
    }
    return mark_at(0);
  }

  void add_children(const std::string& path, const ptree& tree) {
    for (const auto& [name, child] : tree) {
      if (name.starts_with('<')) continue;  // attributes
      Value value{path.empty() ? name : path + "/" + name, {}, place_of(name), {}, {}};
      value.key_place = value.place;
      std::istringstream words(child.data());
      for (std::string word; words >> word;) value.words.push_back({word, value.place});
      const bool has_children = std::any_of(child.begin(), child.end(), [](const auto& each) {
        return !each.first.starts_with('<');
      });
      value.kind = has_children              ? Value::Kind::map
                   : value.words.empty()     ? Value::Kind::null
                   : value.words.size() == 1 ? Value::Kind::scalar
                                             : Value::Kind::list;
      const std::string below = value.path;
      values_.values_.push_back(std::move(value));
      if (has_children) add_children(below, child);
    }
  }

  const std::string& text_;
  std::size_t at_ = 0;
  CameraValues values_;
};

CameraValues CameraValues::of_xml(const std::string& text) { return XmlValues(text).read(); }

}  // namespace weft::cameras
