// SPDX-License-Identifier: Apache-2.0
#include "cli/plugins/check_report.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "kit/conformance/check_list.hpp"

namespace weft::cli {
namespace {

using nlohmann::ordered_json;

/// Text as XML; omits characters that XML cannot represent.
std::string xml_text(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '&') {
      result += "&amp;";
    } else if (c == '<') {
      result += "&lt;";
    } else if (c == '"') {
      result += "&quot;";
    } else if (static_cast<unsigned char>(c) >= 0x20 || c == '\n' || c == '\t') {
      result += c;
    }
  }
  return result;
}

std::string xml_case(const conformance::Report& report, const conformance::Finding& finding) {
  const std::string start = fmt::format("    <testcase classname=\"{}\" name=\"{}\"",
                                        xml_text(report.id), xml_text(finding.check));
  const std::string seen = xml_text(finding.seen);
  if (finding.verdict == conformance::Verdict::holds) return start + "/>\n";
  const char* kind = finding.verdict == conformance::Verdict::fails ? "failure" : "skipped";
  return fmt::format("{}><{} message=\"{}\"/></testcase>\n", start, kind, seen);
}

std::size_t count_skipped(const conformance::Report& report) {
  return report.count(conformance::Verdict::does_not_apply) +
         report.count(conformance::Verdict::deviates);
}

std::string counted(const conformance::Report& report) {
  std::string text = fmt::format("{} hold", report.count(conformance::Verdict::holds));
  const auto add = [&](conformance::Verdict verdict, const char* words) {
    if (report.count(verdict) > 0) text += fmt::format(", {} {}", report.count(verdict), words);
  };
  const auto reduced =
      std::count_if(report.findings.begin(), report.findings.end(), conformance::is_reduced);
  if (reduced > 0) text += fmt::format(" ({} reduced)", reduced);
  add(conformance::Verdict::fails, "fail");
  add(conformance::Verdict::deviates, "deviate");
  add(conformance::Verdict::does_not_apply, "do not apply");
  return text;
}

}  // namespace

ordered_json report_json(const std::vector<conformance::Report>& reports, std::uint64_t seed) {
  ordered_json components = ordered_json::array();
  for (const conformance::Report& report : reports) {
    ordered_json checks = ordered_json::array();
    for (const conformance::Finding& finding : report.findings) {
      checks.push_back(
          {{"name", finding.check}, {"outcome", to_text(finding.verdict)}, {"seen", finding.seen}});
    }
    components.push_back({{"id", report.id},
                          {"library", report.library},
                          {"fails", report.fails()},
                          {"skipped", report.skipped},
                          {"checks", std::move(checks)}});
  }
  return {{"seed", seed}, {"components", std::move(components)}};
}

std::string report_junit(const std::vector<conformance::Report>& reports) {
  std::string text = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n";
  for (const conformance::Report& report : reports) {
    text +=
        fmt::format("  <testsuite name=\"{}\" tests=\"{}\" failures=\"{}\" skipped=\"{}\">\n",
                    xml_text(report.id), report.findings.size() + (report.skipped.empty() ? 0 : 1),
                    report.count(conformance::Verdict::fails),
                    count_skipped(report) + (report.skipped.empty() ? 0 : 1));
    for (const conformance::Finding& finding : report.findings) text += xml_case(report, finding);
    if (!report.skipped.empty()) {
      text += xml_case(report, {"calls", conformance::Verdict::does_not_apply, report.skipped});
    }
    text += "  </testsuite>\n";
  }
  return text + "</testsuites>\n";
}

void print_report(const conformance::Report& report, bool verbose) {
  fmt::print("{}: {}{}\n", report.id, counted(report),
             report.skipped.empty() ? "" : "; skipped where it is called: " + report.skipped);
  for (const conformance::Finding& finding : report.findings) {
    const bool is_printed = verbose || finding.verdict == conformance::Verdict::fails ||
                            finding.verdict == conformance::Verdict::deviates;
    if (!is_printed) continue;
    fmt::print(
        "  {:<9} {}{}{}\n",
        finding.verdict == conformance::Verdict::does_not_apply ? "-" : to_text(finding.verdict),
        finding.check, finding.seen.empty() ? "" : ": ", finding.seen);
  }
  std::fflush(stdout);  // the next one may take minutes
}

void print_summary(const std::vector<conformance::Report>& reports) {
  const auto count = [&](auto&& is_it) {
    return std::count_if(reports.begin(), reports.end(), is_it);
  };
  fmt::print("{} checked: {} fail, {} skipped\n", reports.size(),
             count([](const conformance::Report& report) { return report.fails(); }),
             count([](const conformance::Report& report) { return !report.skipped.empty(); }));
}

void print_check_list() {
  fmt::print("| check | what holds | brief |\n|---|---|---|\n");
  for (const conformance::CheckInfo& info : conformance::all_checks()) {
    fmt::print("| `{}` | {} | {} |\n", info.name, info.sentence, info.brief ? "yes" : "");
  }
}

}  // namespace weft::cli
