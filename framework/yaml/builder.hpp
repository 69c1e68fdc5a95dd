// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <yaml-cpp/eventhandler.h>

#include <cstddef>
#include <string>
#include <unordered_map>
#include <vector>

#include "yaml/text.hpp"
#include "yaml/yaml.hpp"

namespace weft::yaml::detail {

/// Thrown to end the reading after a problem that makes going on pointless.
struct Stop {};

/// Stands for a '?' in what yaml-cpp gets: a byte that no UTF-8 has and no escape makes.
inline constexpr char kQuestionMark = '\xC0';
std::string with_question_marks(std::string text);

/// Builds a document from the events of yaml-cpp and collects its problems; throws Fault where
/// yaml-cpp accepts what is no YAML, and Stop.
class Builder final : public YAML::EventHandler {
 public:
  /// Both arguments must outlive this.
  Builder(const Text& text, Document& document) : text_(text), document_(document) {}

  /// The message for an alias whose anchor yaml-cpp does not know.
  std::string unknown_anchor(const std::string& name) const;

  void OnDocumentStart(const YAML::Mark& mark) override;
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override;
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override;
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override;
  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value style) override;
  void OnSequenceEnd() override { end(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value style) override;
  void OnMapEnd() override { end(); }
  void OnAnchor(const YAML::Mark& mark, const std::string& name) override;

 private:
  /// A collection that is still open.
  struct Frame {
    Node node;
    YAML::anchor_t anchor = 0;
    std::size_t offset = 0;  ///< [bytes]
    bool flow = false;       ///< written inside [ ] or { }
    bool has_key = false;    ///< for maps: the next node is the value of `key`
    bool drops_value = false;
    std::string key;
    Position key_at;
    std::size_t key_offset = 0;  ///< [bytes]
    std::unordered_map<std::string, Position> keys;
  };

  /// The node that an anchor names.
  struct Anchored {
    Node node;
    std::size_t nodes = 0;  ///< [values]
    std::size_t depth = 0;  ///< [collections]
  };

  bool expects_key() const;
  std::size_t begin(const YAML::Mark& mark);
  void start(Kind kind, const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
             YAML::EmitterStyle::value style);
  void end();
  void deliver(Node node, std::size_t offset, YAML::anchor_t anchor);
  void take_key(Frame& map, Node node, std::size_t offset);
  void check_tag(const std::string& tag, Kind kind, std::size_t offset);
  Position place_of_null(std::size_t offset) const;
  void refuse_missing_value(std::size_t offset) const;
  void problem(Position at, std::string message);

  const Text& text_;
  Document& document_;
  std::vector<Frame> open_;
  std::unordered_map<YAML::anchor_t, Anchored> anchored_;
  std::vector<std::string> anchor_names_;
  std::size_t nodes_ = 0;  ///< [values]
  bool started_ = false;
};

}  // namespace weft::yaml::detail
