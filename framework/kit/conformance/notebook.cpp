// SPDX-License-Identifier: Apache-2.0
#include "kit/conformance/notebook.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstring>
#include <exception>

#include "kit/conformance/check_list.hpp"
#include "kit/conformance/probes/processor_time.hpp"

namespace weft::conformance {
namespace {

// A note is its kind and fields, separated and ended by characters that no text of ours has.
constexpr char kBegun = 'b', kEnded = 'e', kRemark = 'r';
constexpr char kField = '\x1f', kEnd = '\x1e';
constexpr int kMostReported = 4;  ///< maximum number of reports of one check

}  // namespace

void Page::fail(const std::string& seen) {
  if (verdict_ != Verdict::fails) seen_.clear();
  verdict_ = Verdict::fails;
  if (seen_.find(seen) != std::string::npos && !seen_.empty()) return;
  if (++reported_ > kMostReported) return;
  seen_ += (seen_.empty() ? "" : "; ") + (reported_ == kMostReported ? "and more" : seen);
}

void Page::skip(const std::string& why) {
  if (failed()) return;
  verdict_ = Verdict::does_not_apply;
  seen_ = why;
}

void Page::note(const std::string& figure) {
  if (verdict_ == Verdict::holds) seen_ = figure;
}

void Page::note_count(std::int64_t made, std::int64_t all, const std::string& what) {
  note(made >= all ? fmt::format("{} {}", made, what)
                   : fmt::format("{}{} of {} {}", kReduced, made, all, what));
}

bool Notebook::is_chosen(const std::string& name) const {
  const CheckInfo* info = find_check(name);
  return choice_.takes(name) && (!choice_.brief || info == nullptr || info->brief);
}

void Notebook::check(const std::string& name, const std::function<void(Page&)>& body) {
  begin(name);
  if (!open_) return;
  Page page;
  try {
    body(page);
  } catch (const std::exception& thrown) {
    page.fail(std::string("threw: ") + thrown.what());
  }
  end(page);
}

void Notebook::begin(const std::string& name) {
  open_.reset();
  if (!is_chosen(name)) return;
  open_ = name;
  write(kBegun + name + kField + std::to_string(own_processor_ms()) + kEnd);
}

void Notebook::end(const Page& page) {
  if (!open_) return;
  const Finding found = page.finding(*open_);
  open_.reset();
  add(found);
}

void Notebook::add(const Finding& found) {
  const char verdict = static_cast<char>('0' + static_cast<int>(found.verdict));
  write(kEnded + found.check + kField + verdict + kField + found.seen + kEnd);
}

void Notebook::write(const std::string& line) const {
  if (getpid() != process_) _exit(0);  // a copy, which a component made with fork() and let return
  for (std::size_t done = 0; done < line.size();) {
    const ssize_t wrote = ::write(file_, line.data() + done, line.size() - done);
    if (wrote <= 0) return;  // the reader has gone
    done += static_cast<std::size_t>(wrote);
  }
}

void Notebook::remark(int file, const char* text) {
  const char before = kRemark, behind = kEnd;
  static_cast<void>(!::write(file, &before, 1));
  static_cast<void>(!::write(file, text, std::strlen(text)));
  static_cast<void>(!::write(file, &behind, 1));
}

Notes read_notes(const std::string& written) {
  Notes notes;
  for (std::size_t at = 0; at < written.size();) {
    const std::size_t end = written.find(kEnd, at);
    if (end == std::string::npos) break;
    const std::string note = written.substr(at + 1, end - at - 1);
    const char kind = written[at];
    at = end + 1;
    const std::size_t first = note.find(kField);
    if (kind == kRemark) notes.remarks += note;
    if (kind == kBegun && first != std::string::npos) {
      notes.unfinished = note.substr(0, first);
      notes.begun_ms = std::stod(note.substr(first + 1));
      notes.remarks.clear();
    }
    if (kind != kEnded) continue;
    const std::size_t second = note.find(kField, first + 1);
    if (second == std::string::npos) continue;
    notes.findings.push_back({note.substr(0, first), static_cast<Verdict>(note[first + 1] - '0'),
                              note.substr(second + 1)});
    notes.unfinished.clear();
  }
  return notes;
}

}  // namespace weft::conformance
