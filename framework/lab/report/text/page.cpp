// SPDX-License-Identifier: Apache-2.0
#include "lab/report/text/page.hpp"

#include <fmt/format.h>

#include <fstream>
#include <iterator>
#include <optional>

#include "lab/report/text/text_table.hpp"

namespace weft::lab {
namespace {

std::optional<std::string> read_text(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) return std::nullopt;
  return std::string(std::istreambuf_iterator<char>(stream), {});
}

std::string header(const Page& page) {
  return fmt::format(
      "<header><button type=\"button\" id=\"theme\" hidden>Light / dark</button>\n"
      "<h1>{}</h1>\n<p class=\"muted\">{}</p></header>\n",
      html_escaped(page.title), html_escaped(page.subtitle));
}

std::string footer(const Page& page, const PageAssets& assets) {
  std::string text = fmt::format(
      "<footer><p>Written from <code>{}</code> by <code>weft report</code>. The page holds all "
      "that "
      "it shows and loads nothing.</p>\n",
      html_escaped(page.folder));
  if (!assets.licences.empty()) {
    text += "<details><summary>Licences of the libraries in this page</summary><pre>" +
            html_escaped(assets.licences) + "</pre></details>\n";
  }
  return text + "</footer>\n";
}

std::string body(const std::vector<Section>& sections) {
  std::string links, text;
  for (const auto& [id, title, content] : sections) {
    if (content.empty()) continue;
    links += fmt::format("<a href=\"#{}\">{}</a>\n", id, title);
    text += fmt::format("<section id=\"{}\"><h2>{}</h2>\n{}</section>\n", id, title, content);
  }
  return "<nav>" + links + "</nav>\n" + text;
}

std::string checkbox(const std::string& parts, const std::string& label) {
  return fmt::format("<label><input type=\"checkbox\" value=\"{}\" checked> {}</label>\n", parts,
                     label);
}

}  // namespace

Result<PageAssets> read_assets(const std::string& folder) {
  const auto style = read_text(folder + "/report.css");
  if (!style) {
    return Error{
        Errc::not_found,
        "there is no such file, but it belongs to the program: build or install Weft again",
        folder + "/report.css"};
  }
  return PageAssets{*style, read_text(folder + "/report.js").value_or(""),
                    read_text(folder + "/licences.txt").value_or("")};
}

// Appended to, never joined: a page has megabytes.
std::string page_html(const Page& page, const PageAssets& assets) {
  constexpr std::size_t kRest = 1 << 18;  // typical size of a page without scripts and data
  std::string text = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta name=\"color-scheme\" content=\"light dark\">\n<title>{}</title>\n"
      "<link rel=\"icon\" href=\"data:,\">\n<style>\n",
      html_escaped(page.title));
  text.reserve(assets.script.size() + page.data.size() + kRest);
  text += assets.style + "</style></head>\n<body>\n" + header(page);
  if (!assets.scripted()) {
    text +=
        "<p class=\"notice\">This report has tables only: the figures and the 3D view are built "
        "with npm, which was absent when Weft was built. Install npm, run "
        "<code>scripts/bootstrap.sh</code>, build again and repeat <code>weft report</code>.</p>\n";
  }
  text += body(page.sections) + footer(page, assets);
  if (assets.scripted()) {
    text.append("<script type=\"application/json\" id=\"weft-data\">").append(page.data);
    text.append("</script>\n<script>").append(assets.script).append("</script>\n");
  }
  text += "</body></html>\n";
  return text;
}

std::string viewer_html(const std::string& about, bool has_truth) {
  const std::string lines =
      has_truth ? " A line leads from each true point to its place on the estimate, longer than it "
                  "is where the errors are enlarged."
                : "";
  const std::string truth_parts =
      checkbox("truth", "<span class=\"key truth\"></span>true points") +
      checkbox("errors", "errors") +
      "<label><input type=\"checkbox\" class=\"by-error\" value=\"\" checked> coloured by "
      "error</label>\n";
  return "<p>" + about + lines +
         " Drag to turn, scroll to come nearer.</p>\n<p "
         "class=\"needs-script\">The 3D view needs JavaScript.</p>\n" +
         fmt::format("<div id=\"viewer\"{}>", has_truth ? "" : " class=\"without-truth\"") +
         "<div class=\"controls\"><label>Cell <select "
         "aria-label=\"Cell\"></select></label></div>\n"
         "<canvas aria-label=\"Shapes in 3D\"></canvas>\n<div class=\"controls\">"
         "<button type=\"button\" class=\"plain play\">Play</button>\n"
         "<input type=\"range\" min=\"0\" max=\"0\" value=\"0\" step=\"1\" "
         "aria-label=\"Frame\">\n<output class=\"readout\"></output></div>\n"
         "<div class=\"controls\">" +
         checkbox("surface edges", "<span class=\"key estimate\"></span>estimate") +
         "<span class=\"controls of-truth\">" + truth_parts +
         "<label>enlarged <select class=\"enlarged\" aria-label=\"Errors enlarged\">"
         "<option value=\"1\">1×</option><option value=\"10\">10×</option>"
         "<option value=\"50\">50×</option></select></label></span>\n"
         "<label><input type=\"checkbox\" class=\"axes\" value=\"\" checked> axes</label>\n"
         "<button type=\"button\" class=\"plain reset\">Reset the view</button>\n"
         "<button type=\"button\" class=\"plain save-gltf\" title=\"Save these frames as glTF, "
         "for Blender\">Save as glTF</button></div>\n"
         "<div class=\"error-scale\" hidden><span>0</span><span class=\"ramp\"></span><span "
         "class=\"high\"></span></div>\n"
         "<p class=\"small\">Again: <code class=\"command\"></code></p></div>\n";
}

std::string script_safe(const std::string& json) {
  // A text could contain the closing tag of the element that contains the JSON.
  std::string text;
  text.reserve(json.size());
  for (const char c : json) {
    if (c == '<') {
      text += "\\u003c";
    } else {
      text += c;
    }
  }
  return text;
}

std::string text_of_file(const std::string& file) { return read_text(file).value_or(""); }

std::string facts_html(const std::vector<std::pair<std::string, std::string>>& facts,
                       const std::string& command) {
  std::string text = "<dl class=\"facts\">\n";
  for (const auto& [name, value] : facts) {
    text += "<dt>" + html_escaped(name) + "</dt><dd>" + html_escaped(value) + "</dd>\n";
  }
  return text + "<dt>command</dt><dd><code class=\"command\">" + html_escaped(command) +
         "</code></dd>\n</dl>\n";
}

}  // namespace weft::lab
